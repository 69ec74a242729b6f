/*
 * record_input CASE: runs a closed loop on the simulated board (plant `bench` of the experiments)
 * and writes the raw samples of every period, the board's facts and the drive_hash reached as a
 * header for replay.c. `record_input --hash CASE` prints drive_hash and trace_hash instead.
 */
#include <cinttypes>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <vector>

#include "sil/board/board.h"
#include "tests/target/replay_case.h"

namespace
{

/* FNV-1a over everything the simulation shows: true state, samples, duties. */
class TraceHash
{
  public:
    template <typename T> void add(const T &value)
    {
        unsigned char bytes[sizeof value];
        std::memcpy(bytes, &value, sizeof value);
        for (unsigned char byte : bytes)
            hash_ = (hash_ ^ byte) * UINT64_C(0x100000001b3);
    }

    std::uint64_t value() const
    {
        return hash_;
    }

  private:
    std::uint64_t hash_ = UINT64_C(0xcbf29ce484222325);
};

struct Recording {
    hal_facts facts;
    std::vector<replay_samples> input;
    std::uint64_t drive_hash = 0;
    std::uint64_t trace_hash = 0;
};

plant::Config bench_plant(const drive_settings &settings)
{
    plant::Config config;
    config.motor = {settings.motor.resistance_ohm,       settings.motor.inductance_H,
                    settings.motor.torque_constant_Nm_A, settings.motor.viscous_friction_Nms_rad,
                    settings.motor.inertia_kgm2,         settings.motor.rotor_teeth};
    config.bridge.bus_V = settings.motor.supply_V;
    if (settings.feedback == DRIVE_FEEDBACK_ENCODER)
        config.sensors.encoder_counts_per_turn = REPLAY_ENCODER_COUNTS;
    return config;
}

replay_samples packed(const hal_samples &samples, std::int32_t encoder_count_before)
{
    const std::int32_t step = samples.encoder_count - encoder_count_before;

    if (samples.flags || step != std::int16_t(step))
        throw std::runtime_error("a sample that replay_samples does not hold");
    return {samples.current_a,       samples.current_b,       samples.bus_voltage,
            samples.phase_voltage_a, samples.phase_voltage_b, std::int16_t(step)};
}

Recording record(const replay_case &which)
{
    drive_settings settings;
    replay_settings(&which, &settings);
    sil::Board board(bench_plant(settings), REPLAY_IMAGE, settings);

    Recording recording{board.facts(), {}, 0, 0};
    TraceHash trace;
    int next_command = 0;
    std::int32_t encoder_count = 0;
    for (std::uint32_t k = 0; k < REPLAY_PERIODS; ++k) {
        while (next_command < which.command_count &&
               which.commands[next_command].at_period <= k + 1)
            board.command(which.commands[next_command++]);
        if (k == REPLAY_LOAD_FROM || k == REPLAY_LOAD_TO)
            board.plant().set_load_torque(k == REPLAY_LOAD_FROM ? 0.1 : 0.0);
        recording.input.push_back(packed(board.samples(), encoder_count));
        encoder_count = board.samples().encoder_count;
        board.control();
        if (k == REPLAY_READY && board.signals().state != DRIVE_OPERATION_ENABLED)
            throw std::runtime_error("the drive is not ready when the moves begin");
        if (board.signals().fault != DRIVE_FAULT_NONE)
            throw std::runtime_error(drive_fault_name(board.signals().fault));
        const plant::State &state = board.plant().state();
        for (double value : {state.theta_rad, state.omega_rad_s, state.i_a_A, state.i_b_A,
                             state.u_a_V, state.u_b_V})
            trace.add(value);
        trace.add(recording.input.back());
        trace.add(board.outputs().high_counts);
        board.advance();
    }
    recording.drive_hash = board.drive_hash();
    trace.add(recording.drive_hash);
    recording.trace_hash = trace.value();
    return recording;
}

/* Of a board that does not measure its temperature, nor asks for an index. */
void write_header(const replay_case &which, const Recording &recording)
{
    const hal_facts &facts = recording.facts;
    std::printf("/* Written by record_input: the recorded input of the closed loop `%s`. */\n",
                which.name);
    std::printf("static const char replay_case_name[] = \"%s\";\n", which.name);
    std::printf("static const uint64_t replay_drive_hash = UINT64_C(0x%016" PRIx64 ");\n",
                recording.drive_hash);
    std::printf(
        "static const struct hal_facts replay_facts = {\n"
        "    \"%s\", %a, %" PRIu32 "u, %a, %a, %a,\n    %" PRIu32
        "u, %a, %uu, %a, %a, %a,\n    %s, %" PRIu32 "u, %s, %s, %s, %a, 0.0, %" PRIu32 "u,\n"
        "    %" PRIu32 "u, %" PRIu32 "u};\n",
        facts.board_name, facts.control_period_s, facts.pwm_half_period_counts, facts.dead_time_s,
        facts.leg_delay_s, facts.low_state_s, facts.converter_codes, facts.current_A_per_code,
        unsigned{facts.current_zero_code}, facts.current_offset_codes, facts.bus_V_per_code,
        facts.phase_voltage_V_per_code, facts.has_phase_voltages ? "true" : "false",
        facts.encoder_counts_per_turn, facts.zero_delay ? "true" : "false",
        facts.has_brake ? "true" : "false", "false", facts.bridge_resistance_ohm,
        facts.cycle_counter_Hz, facts.parameter_page_bytes, facts.parameter_word_bytes);
    std::printf("static const struct replay_samples replay_input[REPLAY_PERIODS] = {\n");
    for (const replay_samples &s : recording.input)
        std::printf("{%d,%d,%d,%d,%d,%d},\n", s.current_a, s.current_b, s.bus_voltage,
                    s.phase_voltage_a, s.phase_voltage_b, s.encoder_step);
    std::printf("};\n");
}

} // namespace

int main(int argc, char **argv)
{
    bool hash_only = argc == 3 && std::strcmp(argv[1], "--hash") == 0;
    const replay_case *which = argc == 2 || hash_only ? replay_case_named(argv[argc - 1]) : nullptr;
    if (!which) {
        std::fprintf(stderr, "usage: record_input [--hash] CASE, a name of replay_case.h\n");
        return 2;
    }
    try {
        Recording recording = record(*which);
        if (hash_only)
            std::printf("drive_hash 0x%016" PRIx64 "\ntrace_hash 0x%016" PRIx64 "\n",
                        recording.drive_hash, recording.trace_hash);
        else
            write_header(*which, recording);
    } catch (const std::exception &error) {
        std::fprintf(stderr, "record_input %s: %s\n", which->name, error.what());
        return 1;
    }
    return 0;
}
