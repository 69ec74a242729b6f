/*
 * Homing through CANopen. On a hard stop: every fourth motor of the library that the board can
 * drive, with the argument `all` every one, parts as built. A motor that is not homed says so, by
 * its statusword; none is homed elsewhere. On the encoder's index: from all around, both ways.
 */
#include "tests/unit/homing_bench.h"

namespace
{

using namespace homing;

const char *const encoder = "drive.feedback = \"encoder\"\nplant.encoder_counts_per_turn = 16384\n";

void test_without_a_load_without_an_encoder()
{
    expect_homed({"", "float", "", -1, 0.0, 100.0, 65536}, {53, 11});
    expect_homed({"", "fixed", "", -2, 0.0, 100.0, 65536}, {53, 11});
}

void test_against_a_quarter_of_the_rated_load_without_an_encoder()
{
    expect_homed({"", "fixed", "", -1, 0.25, 100.0, 65536}, {55, 13});
    expect_homed({"", "float", "", -2, 0.25, 100.0, 65536}, {54, 13});
}

void test_with_an_encoder()
{
    expect_homed({"", "float", encoder, -1, 0.25, 100.0, 65536}, {52, 11});
    expect_homed({"", "fixed", encoder, -2, 0.0, 100.0, 65536}, {52, 11});
}

/* What opposes the motion, an eighth of a turn long, is below the torque. */
void test_a_load_is_no_stop()
{
    TEST_ASSERT_EQUAL(0, homing_of_all({"", "fixed", "", -2, 0.25, 0.0, 65536 / 8}).homed);
    TEST_ASSERT_EQUAL(0, homing_of_all({"", "float", encoder, -1, 0.5, 0.0, 65536 / 8}).homed);
}

/* A quarter of the torque, 0.082 N m, over a quarter of a full step is 10 N m/rad. */
void test_what_gives_way_is_no_stop()
{
    for (const char *numeric : {"float", "fixed"}) {
        for (const double stiffness_Nm_rad : {1.0, 3.0, 5.0}) {
            const Outcome found =
                Machine({"bendjedia-2012", numeric, "", -1, 0.0, stiffness_Nm_rad, 65536}).homing();
            TEST_ASSERT_EQUAL_HEX(reached | failed, found.status & homing_bits);
        }
    }
}

void test_the_index_is_one_place_from_all_around_and_both_ways()
{
    for (const char *numeric : {"float", "fixed"}) {
        double most_counts = 0;
        for (int n = 0; n < 8; n++) {
            const std::string more =
                scenario::format("drive.feedback = \"encoder\"\ndrive.encoder_zero_known = true\n"
                                 "plant.encoder_counts_per_turn = %d\n"
                                 "plant.initial_theta_rad = %g\n",
                                 Machine::counts_per_turn, 0.8 * n - 2.0);
            Machine machine({"bendjedia-2012", numeric, more, 0, 0, 0, 65536});
            const Machine::Place up = machine.at_index(n % 2 == 0 ? 34 : 33);
            const Machine::Place down = machine.at_index(n % 2 == 0 ? 33 : 34);
            for (const Machine::Place &place : {up, down}) {
                TEST_ASSERT_EQUAL_HEX(reached | attained, place.status & homing_bits);
                most_counts = std::fmax(most_counts, std::fabs(place.off_counts));
            }
            TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0,
                                      std::remainder(up.zero_rad - down.zero_rad, 2 * pi));
        }
        std::printf("%s: on the index, within %.2f counts\n", numeric, most_counts);
        TEST_ASSERT_TRUE(most_counts < 1.0);
    }
}

void test_without_an_index_it_is_not_homed()
{
    Machine machine({"bendjedia-2012", "fixed",
                     "drive.feedback = \"encoder\"\ndrive.encoder_zero_known = true\n"
                     "plant.encoder_counts_per_turn = 4000\nplant.encoder_index_rad = -1\n",
                     0, 0, 0, 65536});
    TEST_ASSERT_EQUAL_HEX(reached | failed, machine.at_index(34).status & homing_bits);
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
    RUN_TEST(test_without_a_load_without_an_encoder);
    RUN_TEST(test_against_a_quarter_of_the_rated_load_without_an_encoder);
    RUN_TEST(test_with_an_encoder);
    RUN_TEST(test_a_load_is_no_stop);
    RUN_TEST(test_what_gives_way_is_no_stop);
    RUN_TEST(test_the_index_is_one_place_from_all_around_and_both_ways);
    RUN_TEST(test_without_an_index_it_is_not_homed);
    return UNITY_END();
}
