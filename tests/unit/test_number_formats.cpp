/*
 * What the number formats make of the same samples: a drive in double closes the loop on the plant
 * `bench`, drives in float and fixed point are fed what it measured. They command voltages of their
 * own, which nothing answers to; what they estimate follows from the samples alone.
 */
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <vector>
#include <unity.h>

#include "hal/sil/hal_sil.h"
#include "sil/board/board.h"

namespace
{

constexpr double electrical_degree_rad = 3.14159265358979323846 / 180.0 / 50.0;
constexpr double must_deg = 0.05;

/*
 * A load step at rest is followed from the period on in which it passes a limit, one that is found
 * anew every few periods (invariant_ekf_watch_hold). Where that falls between the crossings of two
 * formats, one begins some periods later, and its angle differs by a third of a degree for 0.15 s.
 * The load is therefore laid at several instants, of which one may be so.
 */
constexpr std::uint32_t instants = 6, periods_apart = 3;
constexpr double late_deg = 0.15;

const motor_params bendjedia_2012 = {0.37, 0.9e-3, 0.157, 0.000307, 15.62e-5, 3.0, 24.0, 50};

struct Recorded {
    hal_facts facts;
    std::vector<hal_samples> samples;
    std::vector<double> theta_est_rad;
};

drive_command command(drive_command_kind kind, std::uint32_t at)
{
    drive_command command{};
    command.kind = kind;
    command.at_period = at;
    return command;
}

constexpr std::uint32_t ready = 5100; /* latest */

/* Enabling, 10 rad with a load that comes and goes, rest under load, slowly back. */
std::vector<drive_command> tape()
{
    drive_command move = command(DRIVE_COMMAND_MOVE_SMOOTH, ready);
    move.position_rad = 10.0;
    move.duration_s = 0.4;
    move.ramp_s = 0.1;
    move.jerk_s = 0.02;
    drive_command back = command(DRIVE_COMMAND_MOVE_SMOOTH, ready + 6000);
    back.position_rad = 9.0;
    back.duration_s = 0.6;
    back.ramp_s = 0.1;
    back.jerk_s = 0.02;
    return {command(DRIVE_COMMAND_ENABLE, 1), move, back};
}

/* What is posted before the interrupt of this period: the drive has to be ready for a move. */
std::vector<drive_command> due(std::uint32_t period)
{
    std::vector<drive_command> commands;
    for (const drive_command &each : tape())
        if (each.at_period == period + 1)
            commands.push_back(each);
    return commands;
}

double load_Nm(std::uint32_t period, std::uint32_t instant)
{
    const std::uint32_t begin = ready + instant * periods_apart;
    return (period > begin + 900 && period < begin + 1900) || period > begin + 4900 ? 0.1 : 0.0;
}

constexpr std::uint32_t periods = ready + 12900;

drive_settings settings()
{
    drive_settings settings;
    drive_settings_default(&settings, &bendjedia_2012);
    return settings;
}

Recorded record(std::uint32_t instant)
{
    plant::Config config;
    config.motor = {bendjedia_2012.resistance_ohm,       bendjedia_2012.inductance_H,
                    bendjedia_2012.torque_constant_Nm_A, bendjedia_2012.viscous_friction_Nms_rad,
                    bendjedia_2012.inertia_kgm2,         bendjedia_2012.rotor_teeth};
    config.bridge.bus_V = bendjedia_2012.supply_V;
    sil::Board board(config, firmware_image_double, settings());
    Recorded recorded{board.facts(), {}, {}};
    for (std::uint32_t k = 0; k < periods; k++) {
        for (const drive_command &each : due(k))
            board.command(each);
        board.plant().set_load_torque(load_Nm(k, instant));
        board.control();
        recorded.samples.push_back(board.samples());
        recorded.theta_est_rad.push_back(board.signals().theta_est_rad);
        board.advance();
    }
    return recorded;
}

/* Rms of the difference of the estimated angles from the drive ready on, electrical degrees. */
double difference_deg(const Recorded &recorded, const firmware_image &image)
{
    const std::unique_ptr<std::max_align_t[]> memory(
        new std::max_align_t[image.drive_bytes / sizeof(std::max_align_t) + 1]());
    void *drive = memory.get();
    const auto board = std::make_unique<hal_sil>();
    char error[DRIVE_ERROR_TEXT] = "";
    const drive_settings given = settings();
    double sum = 0;
    std::size_t count = 0;
    drive_signals signals{};
    hal_sil_init(board.get(), &recorded.facts);
    TEST_ASSERT_TRUE_MESSAGE(image.init(drive, &board->board, &given, error), error);
    for (std::size_t k = 0; k < recorded.samples.size(); k++) {
        for (const drive_command &each : due(static_cast<std::uint32_t>(k)))
            TEST_ASSERT_TRUE_MESSAGE(image.command(drive, &each, error), error);
        hal_sil_control_begins(board.get());
        image.control_cycle(drive, &recorded.samples[k]);
        if (signals.state != DRIVE_OPERATION_ENABLED) /* else its watches miss its own voltages */
            image.background(drive);
        hal_sil_next_period(board.get());
        image.signals(drive, &signals);
        if (signals.state == DRIVE_OPERATION_ENABLED) {
            const double difference = signals.theta_est_rad - recorded.theta_est_rad[k];
            sum += difference * difference;
            count++;
        }
    }
    TEST_ASSERT_TRUE(count > 12000);
    return std::sqrt(sum / static_cast<double>(count)) / electrical_degree_rad;
}

void estimates_what_double_does(const char *format, const firmware_image &image)
{
    int late = 0;
    for (std::uint32_t instant = 0; instant < instants; instant++) {
        const double difference = difference_deg(record(instant), image);
        std::printf("%s: %.4f electrical degrees rms\n", format, difference);
        TEST_ASSERT_TRUE(difference <= late_deg);
        late += difference > must_deg;
    }
    TEST_ASSERT_TRUE(late <= 1);
}

void float_estimates_what_double_does()
{
    estimates_what_double_does("float", firmware_image_float);
}

void fixed_point_estimates_what_double_does()
{
    estimates_what_double_does("fixed", firmware_image_fixed);
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
    RUN_TEST(float_estimates_what_double_does);
    RUN_TEST(fixed_point_estimates_what_double_does);
    return UNITY_END();
}
