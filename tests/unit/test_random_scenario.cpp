/* Random numbers that are the same everywhere, and the scenario texts made of them. */
#include <set>
#include <string>

#include "sil/scenario/campaign.h"
#include "sil/scenario/random_scenario.h"
#include "sil/scenario/text.h"
#include "unity.h"

using namespace scenario;

namespace
{

/* From the definition in the header, worked out in integers of any length by another program. */
void numbers_follow_from_seed_and_stream()
{
    const struct {
        std::uint64_t seed, stream;
        double expected[4];
    } cases[] = {
        {1, 0, {-0.475, 0.323, 0.509, 0.334}},
        {1, 1, {-0.322, 0.522, -0.04, 0.626}},
        {17, 2, {0.938, 0.316, -0.267, -0.895}},
    };
    for (const auto &one : cases) {
        Draw draw(one.seed, one.stream);
        for (const double expected : one.expected) {
            TEST_ASSERT_EQUAL_DOUBLE(expected, draw.between(-1, 1, 1000));
        }
    }
}

void both_ends_are_drawn_and_nothing_beyond()
{
    std::set<std::string> seen;
    Draw draw(3, 0);
    for (int i = 0; i < 1000; ++i) {
        seen.insert(shortest(draw.between(-0.2, 0.2, 10)));
    }
    TEST_ASSERT_EQUAL(5, seen.size());
    TEST_ASSERT_TRUE(seen.count("-0.2") == 1 && seen.count("0") == 1 && seen.count("0.2") == 1);
}

void means_are_those_of_the_distributions()
{
    Draw draw(4, 0);
    double uniform = 0, low = 0, heads = 0;
    const int count = 20000;
    for (int i = 0; i < count; ++i) {
        uniform += draw.between(2, 60, 1000) / count;
        low += draw.mostly_low(2, 60, 1000) / count;
        heads += draw.chance(0.2) ? 1.0 / count : 0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 31, uniform); /* deviation of the mean: 0.12 */
    TEST_ASSERT_DOUBLE_WITHIN(0.5, 2 + 58.0 / 3, low);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 0.2, heads);
}

void a_text_has_its_events_before_its_tables()
{
    ScenarioText text;
    text.text("motor", "m");
    text.table("plant");
    text.number("bus_V", 24.5);
    text.event(0.1, "command = \"stop\"");
    text.expect("metric = \"fault\", equals = \"none\"");
    TEST_ASSERT_EQUAL_STRING("motor = \"m\"\n"
                             "\nevent = [\n  { time_s = 0.1, command = \"stop\" },\n]\n"
                             "\nexpect = [\n  { metric = \"fault\", equals = \"none\" },\n]\n"
                             "\n[plant]\nbus_V = 24.5\n",
                             text.finish().c_str());
}

/* Every kind draws scenarios that the reader takes, another for each seed, the same each time. */
void kinds_draw_scenarios_that_can_be_read()
{
    const Catalogue catalogue("", "");
    for (const CampaignKind *kind : campaign_kinds()) {
        std::set<std::string> texts;
        for (std::uint64_t seed = 0; seed < 50; ++seed) {
            CampaignOrder order;
            order.kind = kind;
            order.duration_s = kind->duration_s;
            const Scenario drawn = drawn_scenario(catalogue, order, seed);
            TEST_ASSERT_EQUAL(seed, drawn.seed);
            TEST_ASSERT_EQUAL_DOUBLE(kind->duration_s, drawn.duration_s);
            const std::string text = kind->draw(seed, kind->duration_s);
            TEST_ASSERT_TRUE(text == kind->draw(seed, kind->duration_s));
            texts.insert(text);
        }
        TEST_ASSERT_EQUAL(50, texts.size());
    }
}

/* A minute has a hundred moves or so, in both directions, and the load changes in each. */
void a_long_run_moves_all_the_time()
{
    const Catalogue catalogue("", "");
    CampaignOrder order;
    order.kind = &long_run_campaign;
    order.duration_s = 60;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        std::size_t moves = 0, loads = 0;
        for (const Event &event : drawn_scenario(catalogue, order, seed).events) {
            moves += event.command ? 1 : 0;
            loads += event.load_torque_Nm ? 1 : 0;
        }
        TEST_ASSERT_GREATER_THAN(100, moves);
        TEST_ASSERT_LESS_THAN(160, moves);
        TEST_ASSERT_GREATER_THAN(60, loads);
    }
}

} // namespace

void setUp()
{
}

void tearDown()
{
}

int main()
{
    UNITY_BEGIN();
    RUN_TEST(numbers_follow_from_seed_and_stream);
    RUN_TEST(both_ends_are_drawn_and_nothing_beyond);
    RUN_TEST(means_are_those_of_the_distributions);
    RUN_TEST(a_text_has_its_events_before_its_tables);
    RUN_TEST(kinds_draw_scenarios_that_can_be_read);
    RUN_TEST(a_long_run_moves_all_the_time);
    return UNITY_END();
}
