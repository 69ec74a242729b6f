/* Random numbers that are the same everywhere, and the scenario texts made of them. */
#include <algorithm>
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

void octaves_are_drawn_alike()
{
    Draw draw(5, 0);
    int low = 0, high = 0;
    const int count = 20000;
    for (int i = 0; i < count; ++i) {
        const double value = draw.over_octaves(0.5, 6); /* 3 octaves and a half of one */
        TEST_ASSERT_TRUE(value >= 0.5 && value <= 6);
        low += value < 1 ? 1 : 0;
        high += value >= 4 ? 1 : 0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.015, 1 / 3.5, low / double(count)); /* deviation: 0.0032 */
    TEST_ASSERT_DOUBLE_WITHIN(0.015, 0.5 / 3.5, high / double(count));
}

void scaled_numbers_are_short_and_a_scale_of_one_changes_nothing()
{
    TEST_ASSERT_EQUAL_DOUBLE(0.001235, significant(0.00123456, 4));
    TEST_ASSERT_EQUAL_DOUBLE(-12.35, significant(-12.3456, 4));
    TEST_ASSERT_EQUAL_DOUBLE(123457, significant(123456.7, 4));
    TEST_ASSERT_EQUAL_DOUBLE(0, significant(0, 4));
    TEST_ASSERT_EQUAL_DOUBLE(0.123456789, times(0.123456789, 1));
    TEST_ASSERT_EQUAL_DOUBLE(0.08223, times(0.15, 0.5482));
}

const motor_params reference = {0.37, 0.9e-3, 0.157, 0.000307, 15.62e-5, 3.0, 24.0, 50};

/* At the rated speed, the drop along the back-EMF and the reactance across it take the supply. */
void ratings_follow_from_the_motor()
{
    const Ratings ratings = ratings_of(reference);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.471, ratings.torque_Nm);
    TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.471 / 15.62e-5, ratings.acceleration_rad_s2);
    const double along = 0.37 * 3 + 0.157 * ratings.speed_rad_s;
    const double across = 50 * 0.9e-3 * 3 * ratings.speed_rad_s;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 24.0 * 24.0, along * along + across * across);
    motor_params weak = reference;
    weak.supply_V = 1;
    TEST_ASSERT_EQUAL_DOUBLE(0, ratings_of(weak).speed_rad_s);
}

void scales_are_one_for_the_reference_and_no_ramp_gets_shorter()
{
    const Ratings own = ratings_of(reference);
    const RatingScales one = scales_of(own, own);
    for (const double scale :
         {one.torque, one.speed, one.acceleration, one.current, one.supply, one.angle}) {
        TEST_ASSERT_EQUAL_DOUBLE(1, scale);
    }
    motor_params other = reference;
    other.inertia_kgm2 /= 40;
    other.rated_current_A = 1.5;
    other.rotor_teeth = 100;
    const RatingScales light = scales_of(ratings_of(other), own);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, light.torque);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, light.current);
    TEST_ASSERT_EQUAL_DOUBLE(0.5, light.angle);
    TEST_ASSERT_EQUAL_DOUBLE(light.speed, light.acceleration);
    other.inertia_kgm2 *= 400;
    const RatingScales heavy = scales_of(ratings_of(other), own);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.05, heavy.acceleration);
}

/* Loads of another motor are a share of its torque, speeds a share of its speed. */
void a_long_run_of_another_motor_goes_with_its_ratings()
{
    const Catalogue catalogue("", "");
    CampaignOrder plain, scaled;
    plain.kind = scaled.kind = &long_run_campaign;
    plain.duration_s = scaled.duration_s = 5;
    scaled.motor.scales.torque = 0.1;
    scaled.motor.scales.supply = 2;
    const Scenario one = drawn_scenario(catalogue, plain, 3);
    const Scenario other = drawn_scenario(catalogue, scaled, 3);
    TEST_ASSERT_EQUAL(one.events.size(), other.events.size());
    for (std::size_t i = 0; i < one.events.size(); ++i) {
        if (one.events[i].load) {
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.1 * one.events[i].load->torque_Nm,
                                      other.events[i].load->torque_Nm);
        }
    }
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2 * one.plant.bridge.bus_V, other.plant.bridge.bus_V);
}

/* Within the ranges of data sheets; those of `motors` go together as well. */
void random_motors_are_those_of_data_sheets()
{
    int apart = 0;
    for (const CampaignKind *kind : {&motors_campaign, &any_motors_campaign}) {
        for (std::uint64_t seed = 0; seed < 200; ++seed) {
            const Drawn drawn = kind->draw(seed, kind->duration_s, {});
            const Motor motor = read_motor_text(drawn.motor, drawn.motor_id);
            const motor_params &of = motor.params;
            const double rated_V = of.resistance_ohm * of.rated_current_A;
            const double holding_Nm = motor.holding_torque_Nm();
            const auto within = [](double low, double value, double high) {
                TEST_ASSERT_TRUE(value >= 0.999 * low && value <= 1.001 * high);
            };
            within(0.4, of.rated_current_A, 6);
            within(2, rated_V, of.rated_current_A < 0.6 ? 12 : 6);
            within(0.5e-3, of.inductance_H / of.resistance_ohm, 6e-3);
            within(0.03, holding_Nm, 4);
            within(0.8e-5, of.inertia_kgm2 / holding_Nm, 3e-4);
            within(std::max(12.0, 4 * rated_V), of.supply_V, 60);
            within(0.02, *motor.detent_torque_Nm / holding_Nm, 0.08);
            const bool encoder =
                drawn.scenario.find("encoder_counts_per_turn = 4000") != std::string::npos;
            TEST_ASSERT_EQUAL(seed % 2 == 0, encoder);
            const double fluxes =
                of.rotor_teeth * of.inductance_H * of.rated_current_A / of.torque_constant_Nm_A;
            const bool together = fluxes >= 0.4 && fluxes <= 4;
            TEST_ASSERT_TRUE(together || kind == &any_motors_campaign);
            apart += together ? 0 : 1;
        }
    }
    TEST_ASSERT_GREATER_THAN(50, apart);
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

/* False where the drive refuses a random motor. */
bool can_be_read(const Catalogue &catalogue, const CampaignOrder &order, std::uint64_t seed)
{
    try {
        const Scenario drawn = drawn_scenario(catalogue, order, seed);
        TEST_ASSERT_EQUAL(seed, drawn.seed);
        if (order.duration_s != CampaignKind::own_duration) {
            TEST_ASSERT_EQUAL_DOUBLE(order.duration_s, drawn.duration_s);
        }
        return true;
    } catch (const InputError &) {
        return false;
    }
}

/* Every kind draws scenarios that the reader takes, another for each seed, the same each time. */
void kinds_draw_scenarios_that_can_be_read()
{
    const Catalogue catalogue("", "");
    for (const CampaignKind *kind : campaign_kinds()) {
        std::set<std::string> texts;
        int readable = 0;
        for (std::uint64_t seed = 0; seed < 50; ++seed) {
            CampaignOrder order;
            order.kind = kind;
            order.duration_s = kind->duration_s;
            readable += can_be_read(catalogue, order, seed) ? 1 : 0;
            const Drawn texts_of_seed = kind->draw(seed, kind->duration_s, {});
            const Drawn again = kind->draw(seed, kind->duration_s, {});
            TEST_ASSERT_TRUE(texts_of_seed.scenario == again.scenario);
            TEST_ASSERT_TRUE(texts_of_seed.motor == again.motor);
            texts.insert(texts_of_seed.scenario + texts_of_seed.motor);
        }
        TEST_ASSERT_EQUAL(50, texts.size());
        TEST_ASSERT_GREATER_OR_EQUAL(kind->draws_motor ? 25 : 50, readable);
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
            loads += event.load ? 1 : 0;
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
    RUN_TEST(octaves_are_drawn_alike);
    RUN_TEST(scaled_numbers_are_short_and_a_scale_of_one_changes_nothing);
    RUN_TEST(ratings_follow_from_the_motor);
    RUN_TEST(scales_are_one_for_the_reference_and_no_ramp_gets_shorter);
    RUN_TEST(a_long_run_of_another_motor_goes_with_its_ratings);
    RUN_TEST(random_motors_are_those_of_data_sheets);
    RUN_TEST(a_text_has_its_events_before_its_tables);
    RUN_TEST(kinds_draw_scenarios_that_can_be_read);
    RUN_TEST(a_long_run_moves_all_the_time);
    return UNITY_END();
}
