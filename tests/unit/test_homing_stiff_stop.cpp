/*
 * Homing on a hard stop that is stiff to each motor of the library, without an encoder: struck at
 * half the default speed, and at twice that, which throws a rotor back.
 */
#include "tests/unit/homing_bench.h"

namespace
{

using namespace homing;

void test_without_a_load()
{
    expect_homed({"", "float", "", -1, 0.0, 100.0, 65536, 20.0, 0.02}, {56, 13});
    expect_homed({"", "fixed", "", -2, 0.0, 100.0, 65536, 20.0, 0.08}, {56, 13});
}

void test_against_a_quarter_of_the_rated_load()
{
    expect_homed({"", "fixed", "", -1, 0.25, 100.0, 65536, 20.0, 0.02}, {56, 13});
    expect_homed({"", "float", "", -2, 0.25, 100.0, 65536, 20.0, 0.08}, {56, 13});
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
    RUN_TEST(test_without_a_load);
    RUN_TEST(test_against_a_quarter_of_the_rated_load);
    return UNITY_END();
}
