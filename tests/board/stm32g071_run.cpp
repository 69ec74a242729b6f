/*
 * Runs the image of the STM32G071 board on the emulated core, from its reset vector, with the motor
 * attached, and the same firmware compiled for this machine beside it: both get the samples of
 * every period and must compute the same, bit for bit.
 *
 * usage: stm32g071_run IMAGE.elf     exit 1 and a line per expectation that does not hold
 */
#include <cinttypes>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <vector>

#include "hal/sil/firmware_image.h"
#include "hal/sil/hal_sil.h"
#include "sil/virtual_board/drive_memory.h"
#include "sil/virtual_board/image_map.h"
#include "sil/virtual_board/machine.h"
#include "sil/virtual_board/peripherals/stm32g071_board.h"
#include "tests/board/stm32g071_motor.h"

namespace
{

using namespace virtual_board;

using stm32g071::host_baud, stm32g071::motor, stm32g071::plant_config;

constexpr double core_Hz = 64e6;
constexpr std::uint64_t must_cycles = 2880;     /* 45 us */
constexpr std::uint64_t deadline_cycles = 5760; /* 90 us */
constexpr std::uint32_t ready = 5600;           /* latest: offsets, hold, balance of the phases */
constexpr std::uint32_t periods = ready + 4000, trip_period = ready + 3600;

/* As hal/stm32g071/port.c gives them. */
hal_facts board_facts()
{
    hal_facts facts = {};
    facts.board_name = "reference";
    facts.control_period_s = 1e-4;
    facts.pwm_half_period_counts = 3200;
    facts.dead_time_s = 5e-9;
    facts.leg_delay_s = 20e-9;
    facts.low_state_s = 4e-6;
    facts.converter_codes = 4096;
    facts.current_A_per_code = 12.0 / 4096.0;
    facts.current_zero_code = 2048;
    facts.current_offset_codes = 4.0;
    facts.bus_V_per_code = 31.2 / 4096.0;
    facts.phase_voltage_V_per_code = 62.4 / 4096.0;
    facts.has_phase_voltages = true;
    facts.bridge_resistance_ohm = 0.18;
    facts.bridge_ntc_beta_K = 3435.0;
    return facts;
}

/* The firmware on this machine. */
class Reference
{
  public:
    explicit Reference(const firmware_image &image)
        : image_(image), drive_(1 + image_.drive_bytes / sizeof(std::max_align_t))
    {
        const hal_facts facts = board_facts();
        drive_settings settings;
        char error[DRIVE_ERROR_TEXT] = "";

        hal_sil_init(&hal_, &facts);
        drive_settings_default(&settings, &motor);
        settings.identify_inductance = false; /* the image has no room for it */
        if (!image_.init(drive_.data(), &hal_.board, &settings, error)) {
            throw std::runtime_error(error);
        }
    }

    void command(const drive_command &command)
    {
        char error[DRIVE_ERROR_TEXT] = "";
        if (!image_.command(drive_.data(), &command, error)) {
            throw std::runtime_error(error);
        }
    }

    void control(const plant::Samples &codes, std::uint32_t flags)
    {
        hal_samples samples = {};
        samples.current_a = codes.current_a;
        samples.current_b = codes.current_b;
        samples.bus_voltage = codes.bus_voltage;
        samples.phase_voltage_a = codes.phase_voltage_a;
        samples.phase_voltage_b = codes.phase_voltage_b;
        samples.flags = flags;
        hal_.bridge_temperature = codes.bridge_temperature;
        hal_sil_control_begins(&hal_);
        (void)image_.control_cycle(drive_.data(), &samples);
        image_.background(drive_.data());
        hal_sil_next_period(&hal_);
    }

    std::uint64_t hash() const
    {
        return image_.hash(drive_.data());
    }

  private:
    const firmware_image &image_;
    std::vector<std::max_align_t> drive_;
    hal_sil hal_;
};

struct Typed {
    drive_command_kind kind;
    std::uint32_t at;
    double position_rad, duration_s, ramp_s;
};
constexpr Typed tape[] = {
    {DRIVE_COMMAND_ENABLE, 200, 0, 0, 0},
    {DRIVE_COMMAND_MOVE_TRAPEZOID, ready + 200, 2.0, 0.120, 0.040},
    {DRIVE_COMMAND_STEP, ready + 1800, 2.03, 0, 0},
    {DRIVE_COMMAND_MOVE_TRAPEZOID, ready + 2100, 6.0, 0.200, 0.060},
    {DRIVE_COMMAND_STOP, ready + 2900, 0, 0, 0},
};
constexpr std::uint32_t load_from = ready + 400, load_to = ready + 1600; /* 0.1 N m */

std::string line_of(const Typed &typed)
{
    char line[160];
    switch (typed.kind) {
    case DRIVE_COMMAND_ENABLE:
        std::snprintf(line, sizeof line, "enable at=%" PRIu32 "\n", typed.at);
        break;
    case DRIVE_COMMAND_MOVE_TRAPEZOID:
        std::snprintf(line, sizeof line,
                      "move-trapezoid position_rad=%a duration_s=%a ramp_s=%a at=%" PRIu32 "\n",
                      typed.position_rad, typed.duration_s, typed.ramp_s, typed.at);
        break;
    case DRIVE_COMMAND_STEP:
        std::snprintf(line, sizeof line, "step position_rad=%a at=%" PRIu32 "\n",
                      typed.position_rad, typed.at);
        break;
    default:
        std::snprintf(line, sizeof line, "stop at=%" PRIu32 "\n", typed.at);
    }
    return line;
}

drive_command command_of(const Typed &typed)
{
    drive_command command = {};
    command.kind = typed.kind;
    command.at_period = typed.at;
    command.position_rad = typed.position_rad;
    command.duration_s = typed.duration_s;
    command.ramp_s = typed.ramp_s;
    return command;
}

int failures = 0;

void expect(bool held, const char *what)
{
    std::printf("%-72s %s\n", what, held ? "held" : "NOT HELD");
    failures += held ? 0 : 1;
}

void print(const char *name, const CycleFigures &figures)
{
    const auto us = [](double cycles) { return cycles / core_Hz * 1e6; };
    std::printf("  %-14s mean %7.1f (%5.2f us)  99.9 %% %5" PRIu64 "  worst %5" PRIu64
                " (%5.2f us)  from flash %5" PRIu64 " (%5.2f us)\n",
                name, figures.nominal.mean, us(figures.nominal.mean), figures.nominal.p999,
                figures.nominal.worst, us(static_cast<double>(figures.nominal.worst)),
                figures.flash.worst, us(static_cast<double>(figures.flash.worst)));
}

int run(const std::string &file)
{
    const ElfImage image = ElfImage::read(file);
    Machine machine(stm32g071_board());
    G071Board board(machine, plant_config(), host_baud);
    machine.attach(board);
    const ImageMap map = ImageMap::read(map_file_of(file), image, machine.costs());
    machine.load(image);
    machine.power_on();
    machine.stops_behind_control_interrupt = true;

    const DriveMemory memory(machine, map);
    Reference reference(map.numeric == firmware_image_one_motor.numeric ? firmware_image_one_motor
                                                                        : firmware_image_fixed);
    std::uint64_t hash = 0;
    std::uint32_t first_difference = UINT32_MAX, next = 0;
    std::uint32_t flags = 0, misplaced = 0;
    struct drive_hash_row before = {};
    double ready_theta = 0, moved_theta = 0;

    board.on_sample = [&machine] { machine.mark_sampling(); };
    Event patience([&machine] { machine.fail("no control interrupt for a second"); });
    for (std::uint32_t k = 0; k < periods; k++) {
        machine.schedule(patience, machine.now() + ticks_per_s);
        machine.run();
        if (!machine.resets().empty()) {
            throw std::runtime_error("reset in period " + std::to_string(k) + ", by " +
                                     machine.resets().front() + " " + machine.fault());
        }
        if (k == 0) {
            hash = memory.gains_hash();
        }
        while (next < std::size(tape) && tape[next].at <= k + 120) {
            board.serial().send(machine.now(), line_of(tape[next]));
            reference.command(command_of(tape[next++]));
        }
        reference.control(board.plant().samples(), flags);
        /* What was computed from S(k-1) acts from S(k) on. */
        for (int leg = 0; k > 0 && leg < 4; leg++) {
            const std::uint32_t pair = before.word[leg / 2];
            misplaced += board.compare(leg) != (leg % 2 == 0 ? pair >> 16 : pair & 0xffffu) ? 1 : 0;
        }
        before = memory.hash_row();
        hash = drive_hash_add(hash, before);
        if (hash != reference.hash() && first_difference == UINT32_MAX) {
            first_difference = k;
        }
        if (k == load_from || k == load_to) {
            board.plant().set_load_torque(k == load_from ? 0.1 : 0.0);
        }
        if (k == ready + 190) {
            ready_theta = board.plant().state().theta_rad;
        } else if (k == ready + 1790) {
            moved_theta = board.plant().state().theta_rad;
        } else if (k == trip_period) {
            expect(board.bridge_on(), "the bridge is on before the trip");
            board.trip();
            expect(!board.bridge_on(), "FAULT opens the bridge without the core");
            flags = HAL_FLAG_OVERCURRENT_TRIP;
        }
    }

    const std::string output = board.serial().take_output();
    std::printf("--- serial line\n%s---\n", output.c_str());
    std::printf("%" PRIu32 " periods, drive_hash 0x%016" PRIx64 ", host 0x%016" PRIx64 "\n",
                periods, hash, reference.hash());
    if (first_difference != UINT32_MAX) {
        std::printf("first difference in period %" PRIu32 "\n", first_difference);
    }
    expect(hash == reference.hash(), "drive_hash is the host's");
    expect(std::fabs(moved_theta - ready_theta - 2.0) < 0.01,
           "the move of 2 rad under 0.1 N m ends within 10 mrad");
    std::printf("  moved by %.5f rad\n", moved_theta - ready_theta);
    expect(memory.signals().fault == DRIVE_FAULT_HARDWARE_OVERCURRENT,
           "the drive reports the trip as its fault");
    expect(misplaced == 0, "the duties of S(k) act on their legs from S(k+1) on");
    expect(board.counters.outside_low_state == 0, "currents are sampled in the low state");
    expect(board.counters.updates_elsewhere == 0, "compares load at the peak only");
    std::printf("  phase a sampled %.3f us, phase b %.3f us from the peak\n",
                static_cast<double>(board.counters.sampled_a_ticks) / 5440.0,
                static_cast<double>(board.counters.sampled_b_ticks) / 5440.0);
    std::printf("  longest time between two feedings of the watchdog %.1f ms\n",
                static_cast<double>(board.watchdog().counters.longest) / 5440.0 / 1000.0);

    const InterruptAccount::Summary summary = machine.account().summary();
    std::printf("control interrupt, %" PRIu64 " times, cycles at 64 MHz; means of the %" PRIu64
                " in which the drive controls\n",
                summary.interrupts, summary.in_control);
    print("whole", summary.total);
    for (std::size_t i = 0; i < summary.stages.size(); i++) {
        if (summary.stages[i].nominal.worst > 0) {
            print(summary.stage_names[i].c_str(), summary.stages[i]);
        }
    }
    std::printf("  latency from the peak: mean %.1f, worst %" PRIu64 " cycles\n",
                summary.latency.mean, summary.latency.worst);
    std::printf("  %" PRIu64 " of its instructions ran from flash\n", summary.outside_fast_code);
    if (const auto stack = machine.stack_used()) {
        std::printf("stack: %" PRIu32 " bytes used\n", *stack);
    }
    /* Reading, writing, entry and return, and the application around the drive. */
    std::uint64_t around = 0;
    for (std::size_t i = 0; i < summary.stages.size(); i++) {
        const std::string &name = summary.stage_names[i];
        const bool port = name == "sampling" || name == "outputs" || name == "other";
        around += port ? summary.stages[i].nominal.least : 0;
    }
    const std::uint64_t blocks = summary.total.nominal.worst - around;
    std::printf("  blocks of the drive: at most %" PRIu64 " cycles (%.2f us)\n", blocks,
                static_cast<double>(blocks) / core_Hz * 1e6);
    expect(blocks <= must_cycles, "the blocks of the drive take at most 45 us");
    expect(summary.total.nominal.worst + summary.latency.worst <= deadline_cycles,
           "the whole control interrupt ends within 90 us of the peak");
    expect(summary.outside_fast_code < 1000, "the control interrupt runs from RAM");
    if (summary.total.nominal.worst > must_cycles) {
        std::printf("  report: the whole control interrupt takes more than 45 us\n");
    }
    return failures > 0 ? 1 : 0;
}

} // namespace

int main(int argc, char **argv)
{
    if (argc != 2) {
        std::fprintf(stderr, "usage: stm32g071_run IMAGE.elf\n");
        return 2;
    }
    try {
        return run(argv[1]);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "stm32g071_run: %s\n", error.what());
        return 1;
    }
}
