#include "sil/board/board.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "firmware/application/settings_record.h"
#include "hal/sil/hal_sil.h"
#include "sil/plant/sensors.h"

namespace sil
{

hal_facts facts_of(const plant::Config &config)
{
    hal_facts facts = {};
    facts.board_name = "steadystep SIL board";
    facts.control_period_s = config.bridge.period_s;
    facts.pwm_half_period_counts = static_cast<std::uint32_t>(config.bridge.half_period_counts);
    facts.dead_time_s =
        config.bridge.model == plant::BridgeModel::switched ? config.bridge.dead_time_s : 0.0;
    facts.leg_delay_s = 20e-9; /* as the reference board, although the plant has none */
    facts.low_state_s = config.sensors.low_state_s;
    facts.converter_codes = static_cast<std::uint32_t>(plant::converter_codes(config.sensors));
    facts.current_A_per_code = plant::current_A_per_code(config.sensors);
    facts.current_zero_code = static_cast<std::uint16_t>(plant::current_zero_code(config.sensors));
    facts.current_offset_codes = current_offset_codes;
    facts.bus_V_per_code = plant::bus_V_per_code(config.sensors);
    facts.bridge_ntc_beta_K = config.sensors.bridge_ntc_beta_K;
    facts.phase_voltage_V_per_code = plant::phase_voltage_V_per_code(config.sensors);
    facts.has_phase_voltages = true;
    facts.zero_delay = config.bridge.delay_periods == 0;
    facts.has_brake = config.supply.brake_by_drive && config.supply.brake_ohm > 0.0;
    facts.encoder_counts_per_turn =
        static_cast<std::uint32_t>(config.sensors.encoder_counts_per_turn);
    facts.has_encoder_index =
        config.sensors.encoder_counts_per_turn > 0 && config.sensors.encoder_index_rad >= 0.0;
    return facts;
}

struct Board::Impl {
    Impl(const plant::Config &config, const firmware_image &firmware,
         const drive_settings &drive_settings, double trip_A)
        : plant(config), image(firmware), settings(drive_settings), hardware_trip_A(trip_A),
          drive_memory(1 + firmware.drive_bytes / sizeof(std::max_align_t))
    {
    }

    void receive();
    void send();

    /* The counter's, of the encoder's; may wrap. */
    std::int32_t counted(std::int32_t encoder_count) const
    {
        return static_cast<std::int32_t>(static_cast<std::uint32_t>(encoder_count) -
                                         static_cast<std::uint32_t>(encoder_origin));
    }

    plant::Plant plant;
    const firmware_image &image;
    const drive_settings settings;
    const double hardware_trip_A;
    bool stores = false;           /* starts with what its parameter store has */
    std::uint64_t hash_before = 0; /* of the drive before the last power cycle */
    std::vector<std::max_align_t> drive_memory;
    void *drive = drive_memory.data();
    hal_sil hal;
    hal_samples samples = {};
    hal_outputs outputs = {};
    bool brake_on = false;
    std::int32_t encoder_origin = 0; /* 0 until a power cycle, from which the counter begins anew */
    std::string typed;               /* arrives in the coming control() */
    bool shorted = false, stalled = false, deadline_missed = false; /* in the present period */
    std::string output;
    drive_signals signals = {};
};

Board::Board(const plant::Config &plant, const firmware_image &image,
             const drive_settings &settings, double hardware_trip_A)
    : impl_(std::make_unique<Impl>(plant, image, settings, hardware_trip_A))
{
    if (!(hardware_trip_A >= 0.0)) {
        throw std::invalid_argument("hardware_trip_A: expected 0 (not fitted) or a current");
    }
    const hal_facts facts = facts_of(plant);
    hal_sil_init(&impl_->hal, &facts);
    start();
    sample();
}

std::unique_ptr<Board> Board::flashed(const plant::Config &plant, const firmware_image &image,
                                      const drive_settings &settings, double hardware_trip_A)
{
    auto board = std::make_unique<Board>(plant, image, settings, hardware_trip_A);
    std::uint8_t record[SETTINGS_RECORD_BYTES];
    settings_record_encode(&settings, 1, record);
    std::copy(std::begin(record), std::end(record),
              &board->impl_->hal.parameters[SETTINGS_RECORD_FIRST_PAGE * HAL_SIL_PAGE_BYTES]);
    board->impl_->stores = true;
    board->start();
    return board;
}

void Board::start()
{
    Impl &board = *impl_;
    char error[DRIVE_ERROR_TEXT] = "";
    const bool started =
        board.stores
            ? board.image.init_stored(board.drive, &board.hal.board, &board.settings.motor, error)
            : board.image.init(board.drive, &board.hal.board, &board.settings, error);
    if (!started) {
        throw std::invalid_argument(error);
    }
    board.image.put_memory(board.drive, board.hal.capture, HAL_CAPTURE_WORDS);
}

Board::~Board() = default;

void Board::power_cycle()
{
    Impl &board = *impl_;
    board.hash_before = drive_hash();
    hal_sil_restart(&board.hal);
    board.typed.clear();
    board.shorted = board.stalled = board.deadline_missed = false;
    start();
    board.outputs = {};
    board.brake_on = false;
    board.encoder_origin = board.plant.samples().encoder_count;
    sample();
}

void Board::command(const drive_command &command)
{
    char error[DRIVE_ERROR_TEXT] = "";
    if (!impl_->image.command(impl_->drive, &command, error)) {
        throw std::invalid_argument(error);
    }
}

/* What the converters and the comparator see at the present S(k). */
void Board::sample()
{
    Impl &board = *impl_;
    const plant::Samples &codes = board.plant.samples();
    board.samples.current_a = codes.current_a;
    board.samples.current_b = codes.current_b;
    board.samples.bus_voltage = codes.bus_voltage;
    board.samples.phase_voltage_a = codes.phase_voltage_a;
    board.samples.phase_voltage_b = codes.phase_voltage_b;
    board.hal.bridge_temperature = codes.bridge_temperature;
    board.samples.encoder_count = board.counted(codes.encoder_count);
    if (codes.index_rise.passed) {
        hal_sil_index_edge(&board.hal, true, board.counted(codes.index_rise.count));
    }
    if (codes.index_fall.passed) {
        hal_sil_index_edge(&board.hal, false, board.counted(codes.index_fall.count));
    }
    if (board.hardware_trip_A > 0.0) {
        const plant::State &state = board.plant.state();
        const double limit = board.hardware_trip_A;
        if (state.i_a_A > limit || state.i_a_A < -limit || state.i_b_A > limit ||
            state.i_b_A < -limit) {
            hal_sil_trip(&board.hal);
        }
    }
    board.samples.flags =
        board.hal.trip_latched ? std::uint32_t{HAL_FLAG_OVERCURRENT_TRIP} : std::uint32_t{0};
    if (board.deadline_missed) {
        board.samples.flags |= HAL_FLAG_DEADLINE_MISSED;
    }
}

void Board::short_circuit(int, double current_A)
{
    impl_->shorted = impl_->hardware_trip_A > 0.0 && current_A > impl_->hardware_trip_A;
}

void Board::stall_control_interrupt(double until_s)
{
    impl_->stalled = until_s > control_deadline_share * impl_->hal.facts.control_period_s;
}

void Board::put_inputs(std::uint32_t levels)
{
    impl_->hal.inputs = levels;
}

std::uint32_t Board::machine_outputs() const
{
    return impl_->hal.outputs;
}

void Board::send(const std::string &bytes)
{
    if (impl_->typed.size() + bytes.size() > HAL_SIL_STREAM_BYTES) {
        throw std::runtime_error("more lines are typed than the board takes in a period");
    }
    impl_->typed += bytes;
}

/* What there is no room for, since the drive has not yet read what came before, is lost. */
void Board::Impl::receive()
{
    const auto *bytes = reinterpret_cast<const std::uint8_t *>(typed.data());
    (void)hal_sil_host_write(&hal, bytes, typed.size());
    typed.clear();
}

void Board::Impl::send()
{
    if (hal.to_host.count == 0) {
        return;
    }
    std::uint8_t bytes[HAL_SIL_STREAM_BYTES];
    const std::size_t count = hal_sil_host_read(&hal, bytes, sizeof bytes);
    output.append(reinterpret_cast<const char *>(bytes), count);
}

void Board::control()
{
    Impl &board = *impl_;
    hal_sil_control_begins(&board.hal);
    if (!board.typed.empty()) {
        board.receive();
    }
    board.outputs = board.image.control_cycle(board.drive, &board.samples);
    if (board.hal.follows) {
        board.image.follow_control(board.drive);
    }
    board.brake_on = board.hal.facts.has_brake && board.image.brake(board.drive, &board.samples);
    board.image.background(board.drive);
    board.send();
    board.image.signals(board.drive, &board.signals);
}

void Board::advance()
{
    Impl &board = *impl_;
    if (std::exchange(board.shorted, false)) {
        hal_sil_trip(&board.hal);
    }
    board.deadline_missed = std::exchange(board.stalled, false);
    plant::Duties duties;
    for (int leg = 0; leg < HAL_LEGS; leg++) {
        duties.high_counts[leg] = board.outputs.high_counts[leg];
    }
    duties.bridge_on =
        board.outputs.bridge_on && hal_sil_bridge_on(&board.hal) && !board.deadline_missed;
    duties.brake_on = board.brake_on;
    board.plant.step(duties);
    hal_sil_next_period(&board.hal);
    if (hal_sil_watchdog_expired(&board.hal)) {
        throw std::logic_error("the watchdog has not been fed: a real board would have been reset");
    }
    sample();
}

std::string Board::take_output()
{
    return std::exchange(impl_->output, {});
}

const drive_signals &Board::signals() const
{
    return impl_->signals;
}

std::uint64_t Board::drive_hash() const
{
    return impl_->hash_before + impl_->image.hash(impl_->drive);
}

plant::Plant &Board::plant()
{
    return impl_->plant;
}

const hal_samples &Board::samples() const
{
    return impl_->samples;
}

std::vector<std::pair<std::string, double>> Board::coefficients() const
{
    std::vector<std::pair<std::string, double>> list;
    impl_->image.coefficients(
        impl_->drive,
        [](void *context, const char *name, double value) {
            static_cast<decltype(list) *>(context)->emplace_back(name, value);
        },
        &list);
    return list;
}

const hal_outputs &Board::outputs() const
{
    return impl_->outputs;
}

const hal_facts &Board::facts() const
{
    return impl_->hal.facts;
}

} // namespace sil
