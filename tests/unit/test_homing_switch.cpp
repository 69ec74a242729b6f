/*
 * Homing on a switch of each motor of the library, as built and without an encoder: its edge is at
 * 1 rad, a limit switch stands behind it, and the load is against the motion, along it, or none.
 */
#include "tests/unit/homing_bench.h"

namespace
{

using namespace homing;

constexpr const char *wired = "[drive]\ninputs_used = 7\n";

Case on_home_switch(const char *numeric, int method, double load)
{
    Case asked{"", numeric, wired, method, load, 0, 10 * 65536, 0, 0.04};
    asked.switches.home_switch_low_rad = stop_rad;
    asked.switches.home_switch_high_rad = stop_rad + 0.5;
    asked.switches.limit_low_rad = -stop_rad;
    asked.switches.limit_high_rad = stop_rad + 1.0;
    asked.switches.wired = HAL_INPUT_HOME | HAL_INPUT_LIMIT_MINUS | HAL_INPUT_LIMIT_PLUS;
    return asked;
}

void test_the_home_switch_is_where_it_is_entered()
{
    expect_homed(on_home_switch("float", 24, 0.0), {55, 13});
    expect_homed(on_home_switch("fixed", 24, 0.25), {52, 12, 4});
}

/* The search goes down, turns at the limit switch, and comes up to the switch. */
void test_the_home_switch_behind_a_turn_is_found()
{
    expect_homed(on_home_switch("fixed", 29, 0.0), {56, 13});
    expect_homed(on_home_switch("float", 29, -0.25), {54, 12, 2});
}

void test_a_limit_switch_is_where_it_is_left()
{
    Case asked = on_home_switch("float", 18, 0.0);
    asked.switches.limit_high_rad = stop_rad;
    expect_homed(asked, {55, 13});
}

} // namespace

void setUp()
{
}

void tearDown()
{
}

int main(int argc, char **argv)
{
    homing::begin(argc, argv);
    RUN_TEST(test_the_home_switch_is_where_it_is_entered);
    RUN_TEST(test_the_home_switch_behind_a_turn_is_found);
    RUN_TEST(test_a_limit_switch_is_where_it_is_left);
    return UNITY_END();
}
