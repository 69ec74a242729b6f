/* What a motor file means: what a data sheet prints becomes the drive's parameters and the plant.
 */
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "sil/scenario/motor_plausibility.h"
#include "sil/scenario/scenario_file.h"
#include "unity.h"

using namespace scenario;
namespace fs = std::filesystem;

namespace
{

constexpr double pi = 3.14159265358979323846;

/* A folder that is gone when the test is. */
struct Scratch {
    Scratch()
    {
        char name[] = "/tmp/motor_file_XXXXXX";
        TEST_ASSERT_NOT_NULL(mkdtemp(name));
        folder = name;
    }
    ~Scratch()
    {
        fs::remove_all(folder);
    }
    Scratch(const Scratch &) = delete;
    Scratch &operator=(const Scratch &) = delete;

    fs::path folder;
};

/* NEMA 17 with `torque_and_inertia` as its data sheet prints them. */
fs::path written(const Scratch &scratch, const std::string &torque_and_inertia)
{
    const fs::path file = scratch.folder / "nema17.toml";
    std::ofstream(file) << "id = \"nema17\"\ndescription = \"\"\nsource = \"\"\n"
                           "resistance_ohm = 5.3\ninductance_H = 6.6e-3\nrated_current_A = 1.0\n"
                           "viscous_friction_Nms_rad = 1e-4\nsupply_V = 24.0\nrotor_teeth = 50\n"
                        << torque_and_inertia;
    return file;
}

constexpr char plain[] = "holding_torque_Nm = 0.27\nrotor_inertia_kgm2 = 3.5e-6\n";

Scenario with_plant(const Scratch &scratch, const std::string &motor, const std::string &plant)
{
    const fs::path file = written(scratch, motor);
    return read_scenario_text(Catalogue({}, {}),
                              "description = \"\"\nduration_s = 0.1\nmotor = \"" + file.string() +
                                  "\"\n[plant]\n" + plant,
                              "test", {});
}

/* The greatest torque of a rotor that is turned by hand, N m. */
double detent_peak_Nm(const Scenario &scenario)
{
    const plant::ImperfectionConfig &of = scenario.plant.imperfections;
    double peak = 0;
    for (int i = 0; i < 100000; ++i) {
        const double angle = 2 * pi * i / 100000;
        peak =
            std::max(peak, of.detent_4 * std::sin(4 * angle) + of.detent_2 * std::sin(2 * angle) +
                               of.detent_1 * std::sin(angle));
    }
    return peak * scenario.motor.holding_torque_Nm();
}

void the_holding_torque_gives_the_torque_constant()
{
    const Scratch scratch;
    const Motor motor = read_motor(written(scratch, plain));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.27 / std::sqrt(2.0), motor.params.torque_constant_Nm_A);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.27, motor.holding_torque_Nm());
}

void of_both_the_torque_constant_counts()
{
    const Scratch scratch;
    const Motor motor =
        read_motor(written(scratch, std::string("torque_constant_Nm_A = 0.21\n") + plain));
    TEST_ASSERT_EQUAL_DOUBLE(0.21, motor.params.torque_constant_Nm_A);
}

void the_drive_is_set_to_rotor_and_load_together()
{
    const Scratch scratch;
    const Motor motor =
        read_motor(written(scratch, std::string(plain) + "load_inertia_kgm2 = 1e-3\n"));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 1e-3 + 3.5e-6, motor.params.inertia_kgm2);
    TEST_ASSERT_EQUAL_DOUBLE(3.5e-6, *motor.rotor_inertia_kgm2);
}

/* Given together, the same load leaves no doubt either: it may be as heavy as that. */
void a_load_does_not_count_as_a_rotor()
{
    const Scratch scratch;
    const std::string heavy = std::string(plain) + "load_inertia_kgm2 = 1e-3\n";
    TEST_ASSERT_EQUAL(0, doubts_about(read_motor(written(scratch, heavy))).size());
    const std::string together = "holding_torque_Nm = 0.27\ninertia_kgm2 = 3.5e-4\n";
    TEST_ASSERT_EQUAL(0, doubts_about(read_motor(written(scratch, together))).size());
}

void a_detent_torque_is_the_peak_of_its_harmonics()
{
    const Scratch scratch;
    const Scenario scenario = with_plant(scratch, std::string(plain) + "detent_torque_Nm = 0.022\n",
                                         "model = \"real\"\n");
    const plant::ImperfectionConfig &of = scenario.plant.imperfections;
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 0.022, detent_peak_Nm(scenario));
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.3 * of.detent_4, of.detent_2);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.15 * of.detent_4, of.detent_1);
}

void without_one_it_is_a_share_of_the_holding_torque()
{
    const Scratch scratch;
    const Scenario scenario = with_plant(scratch, plain, "model = \"real\"\n");
    TEST_ASSERT_EQUAL_DOUBLE(0.05, scenario.plant.imperfections.detent_4);
    TEST_ASSERT_EQUAL_DOUBLE(0.015, scenario.plant.imperfections.detent_2);
    TEST_ASSERT_EQUAL_DOUBLE(0.0075, scenario.plant.imperfections.detent_1);
}

/* Only `real` has a detent, whatever the file says, and a scenario's own value counts more. */
void the_plant_keeps_its_say()
{
    const Scratch scratch;
    const std::string motor = std::string(plain) + "detent_torque_Nm = 0.022\n";
    const Scenario bench = with_plant(scratch, motor, "model = \"bench\"\n");
    TEST_ASSERT_EQUAL_DOUBLE(0, bench.plant.imperfections.detent_4);
    const Scenario real = with_plant(scratch, motor, "model = \"real\"\ndetent_4 = 0.02\n");
    TEST_ASSERT_EQUAL_DOUBLE(0.02, real.plant.imperfections.detent_4);
}

void offsets_and_noise_follow_the_range_in_codes()
{
    const Scratch scratch;
    const plant::SensorConfig six = with_plant(scratch, plain, "model = \"real\"\n").plant.sensors;
    for (const char *range : {"current_range_rated = 2.2\n", "current_range_A = 2.2\n"}) {
        const plant::SensorConfig own =
            with_plant(scratch, plain, std::string("model = \"real\"\n") + range).plant.sensors;
        const double ratio = 2.2 / 6.0;
        TEST_ASSERT_EQUAL_DOUBLE(2.2, own.current_range_A);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, ratio * six.current_offset_on_a_A,
                                  own.current_offset_on_a_A);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, ratio * six.current_offset_on_b_A,
                                  own.current_offset_on_b_A);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, ratio * six.current_noise_rms_A, own.current_noise_rms_A);
    }
    TEST_ASSERT_EQUAL_DOUBLE(3 * 12.0 / 4096, six.current_offset_on_a_A);
    TEST_ASSERT_EQUAL_DOUBLE(3e-3, six.current_noise_rms_A);
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
    RUN_TEST(the_holding_torque_gives_the_torque_constant);
    RUN_TEST(of_both_the_torque_constant_counts);
    RUN_TEST(the_drive_is_set_to_rotor_and_load_together);
    RUN_TEST(a_load_does_not_count_as_a_rotor);
    RUN_TEST(a_detent_torque_is_the_peak_of_its_harmonics);
    RUN_TEST(without_one_it_is_a_share_of_the_holding_torque);
    RUN_TEST(the_plant_keeps_its_say);
    RUN_TEST(offsets_and_noise_follow_the_range_in_codes);
    return UNITY_END();
}
