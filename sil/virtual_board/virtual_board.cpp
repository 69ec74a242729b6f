#include "sil/virtual_board/virtual_board.h"

#include <algorithm>
#include <array>
#include <utility>

#include "firmware/application/settings_record.h"
#include "sil/plant/sensors.h"
#include "sil/virtual_board/board_facts.h"
#include "sil/virtual_board/drive_memory.h"
#include "sil/virtual_board/image_files.h"
#include "sil/virtual_board/peripherals/stm32g474_device.h"

namespace virtual_board
{

namespace
{

/* The parameter store: the last four pages of the flash (hal.h, parameters_*). */
constexpr std::uint32_t parameter_pages = 4;

/* Of a period, after S(k): the last byte of a typed line arrives, the control interrupt is over; a
   leg is shorted. The bridge is open so soon behind that, or a deadline. */
constexpr double arrival_in_period = 0.6, short_in_period = 0.6;
constexpr Ticks opening_time = ticks_per_s / 1'000'000;

/* Where in a period a control interrupt is held up: it has read its samples. */
constexpr Ticks stall_in_period = ticks_per_s / 1'000'000 * 3;
constexpr Ticks before_deadline = ticks_per_s / 1'000'000; /* a stall beyond it comes in pieces */
constexpr Ticks stall_piece = ticks_per_s / 10'000'000;

/* Longest time without a control interrupt: start-up designs the gains. */
constexpr Ticks patience = ticks_per_s;

Stm32g474Config device_config(const plant::Config &plant)
{
    Stm32g474Config config;
    config.power_stage.plant = plant;
    return config;
}

} // namespace

struct VirtualBoard::Impl {
    Impl(const plant::Config &config, const std::string &image_file)
        : machine(stm32g474()), device(machine, device_config(config)),
          image(read_image(image_file)), facts(facts_of(config, image->map.half_period_counts)),
          timeout([this] { machine.fail("no control interrupt for a second"); }),
          trip_check([this] { require_open_bridge("after a leg was shorted"); }),
          deadline_check([this] { require_open_bridge("after the control interrupt's deadline"); }),
          stall([this] { hold_up(); })
    {
        machine.attach(device);
        image->map.give(machine.costs());
        machine.load(image->elf);
        memory.emplace(machine, image->map);
        machine.stops_behind_control_interrupt = true;
        device.power_stage().on_sample = [this](std::int64_t k) { sample(k); };
        device.flash_controller().on_change = [this](std::uint32_t address, std::uint32_t) {
            if (address < Flash::base + store()) {
                machine.fail("erased or programmed the flash outside of the parameter store");
            }
        };
    }

    Ticks share_of_period(double share) const
    {
        return static_cast<Ticks>(
            share * facts.control_period_s * static_cast<double>(ticks_per_s) + 0.5);
    }
    Ticks deadline() const
    {
        return share_of_period(sil::control_deadline_share);
    }

    /* Where the parameter store begins in the flash. */
    std::uint32_t store() const
    {
        return Flash::bytes - parameter_pages * facts.parameter_page_bytes;
    }

    void sample(std::int64_t k)
    {
        machine.mark_sampling();
        sampled_at = machine.now();
        sampled_period = k;
        check_bridge(k);
        if (stops_at_sample) {
            machine.stop();
        }
    }
    void check_bridge(std::int64_t k);
    void hold_up();
    void require_open_bridge(const std::string &when);
    void run();
    void send_typed();

    Machine machine;
    Stm32g474Device device;
    std::shared_ptr<const ImageFiles> image;
    hal_facts facts;
    std::optional<DriveMemory> memory;
    Event timeout, trip_check, deadline_check, stall;
    Ticks stall_end = 0;

    Ticks sampled_at = 0;
    std::int64_t sampled_period = -1; /* k of the last S(k) */
    std::uint64_t outside_low_state = 0;
    struct Duties {
        std::uint32_t period = UINT32_MAX;
        std::array<std::uint32_t, PowerStage::legs> high_counts{};
    };
    std::array<Duties, 4> computed; /* by the drive in the last control interrupts */
    bool stops_at_sample = false;
    std::string typed; /* its last byte arrives in the period of the coming control() */
    drive_signals signals = {};
    std::uint32_t period = 0; /* of the coming control() */
    std::uint64_t hash = 0, hash_before = 0;
    std::vector<std::string> resets;
};

VirtualBoard::VirtualBoard(const plant::Config &plant, const std::string &image_file,
                           const std::string &numeric, const drive_settings &settings)
    : impl_(std::make_unique<Impl>(plant, image_file))
{
    require_image_facts(plant, impl_->image->map, numeric);
    std::vector<std::uint8_t> &flash = impl_->device.flash().memory();
    const std::size_t page = impl_->facts.parameter_page_bytes;
    const std::size_t record_at = impl_->store() + SETTINGS_RECORD_FIRST_PAGE * page;
    drive_settings stored = settings;
    stored.encoder_counts_per_turn = plant.sensors.encoder_counts_per_turn;
    if (settings.feedback ==
        DRIVE_FEEDBACK_SENSORLESS) { /* its counts are a setting of their own */
        stored.initial_angle_rad += stored.initial_angle_error_rad;
        stored.initial_angle_error_rad = 0;
    }
    require_image_settings(stored);
    settings_record_encode(&stored, 1, &flash[record_at]);
    impl_->machine.power_on();
}

VirtualBoard::~VirtualBoard() = default;

/*
 * At S(k): what the legs did since S(k-1) is what the drive computed from S(k-2), leg by leg, and
 * the currents were sampled while all legs were low. Duties that are swapped for all measurements
 * alike would go unseen otherwise, and so would samples that happen to be zero.
 */
void VirtualBoard::Impl::check_bridge(std::int64_t k)
{
    const std::uint64_t outside = device.power_stage().counters.outside_low_state;
    if (!device.power_stage().bridge_on() || k < 2) {
        outside_low_state = outside;
        return;
    }
    if (outside != outside_low_state) {
        machine.fail("a current was sampled while a leg was high, before S(" + std::to_string(k) +
                     ")");
    }
    const auto source = static_cast<std::uint32_t>(k - 2);
    const Duties &wanted = computed[source % computed.size()];
    if (wanted.period != source) {
        return;
    }
    for (int leg = 0; leg < PowerStage::legs; ++leg) {
        const std::uint32_t count = wanted.high_counts[static_cast<std::size_t>(leg)];
        if (device.tim1().active_compare(leg) != count) {
            machine.fail("leg " + std::to_string(leg + 1) + " of 4 was high for " +
                         std::to_string(device.tim1().active_compare(leg)) + " counts before S(" +
                         std::to_string(k) + "); of S(" + std::to_string(k - 2) +
                         ") the drive computed " + std::to_string(count));
        }
    }
}

/* In one piece until just before the deadline, then in small ones: an instruction is not
   interrupted, and what is above the control interrupt is to have its way. */
void VirtualBoard::Impl::hold_up()
{
    const Ticks now = machine.now();
    if (now >= stall_end) {
        return;
    }
    const Ticks first_end = std::min(stall_end, sampled_at + deadline() - before_deadline);
    const Ticks piece = now < first_end ? first_end - now : stall_piece;
    machine.stall_control_interrupt(0, piece / machine.core_cycle());
    machine.schedule(stall, now + piece);
}

void VirtualBoard::Impl::require_open_bridge(const std::string &when)
{
    if (device.power_stage().bridge_on()) {
        machine.fail("the bridge is closed 1 us " + when);
    }
}

/* Until something stops it; a reset that nobody asked for is a failure. */
void VirtualBoard::Impl::run()
{
    machine.schedule(timeout, machine.now() + patience);
    machine.run();
    machine.schedule(timeout, Event::never);
    if (!machine.resets().empty()) {
        const std::string cause = machine.resets().back();
        machine.fail("the chip was reset (" + cause + ")" +
                     (machine.fault().empty() ? "" : " after " + machine.fault()));
    }
}

/* As the reference board's pin map has them: PC8... and PA8... */
constexpr unsigned machine_pins = 8;

void VirtualBoard::put_inputs(std::uint32_t levels)
{
    Gpio &port = impl_->device.pins().port('C');
    for (unsigned pin = 0; (HAL_INPUTS >> pin & 1u) != 0; ++pin) {
        port.drive(machine_pins + pin, (levels >> pin & 1u) != 0);
    }
}

std::uint32_t VirtualBoard::machine_outputs() const
{
    const Gpio &port = impl_->device.pins().port('A');
    std::uint32_t levels = 0;
    for (unsigned pin = 0; (HAL_OUTPUTS >> pin & 1u) != 0; ++pin) {
        levels |= port.drives_high(machine_pins + pin) ? 1u << pin : 0u;
    }
    return levels;
}

void VirtualBoard::control()
{
    Impl &board = *impl_;
    board.stops_at_sample = false;
    const std::uint64_t before = board.machine.control_interrupts();
    while (board.machine.control_interrupts() == before) {
        board.run();
    }
    board.signals = board.memory->signals();
    if (board.signals.period != board.period) {
        board.machine.fail("control interrupt " + std::to_string(board.period) +
                           " left the drive in period " + std::to_string(board.signals.period));
    }
    if (board.period++ == 0) {
        board.hash = board.memory->gains_hash();
    }
    const struct drive_hash_row row = board.memory->hash_row();
    board.hash = drive_hash_add(board.hash, row);
    Impl::Duties &computed = board.computed[board.signals.period % board.computed.size()];
    computed.period = board.signals.period;
    computed.high_counts = {row.word[0] >> 16, row.word[0] & 0xffff, row.word[1] >> 16,
                            row.word[1] & 0xffff};
    board.send_typed();
}

/* Up to the instant of the next S(k), where the plant has just been stepped; a control interrupt
   that has been held up may have passed it. */
void VirtualBoard::advance()
{
    Impl &board = *impl_;
    const std::int64_t next = board.period;
    const std::uint64_t interrupts = board.machine.control_interrupts();
    board.stops_at_sample = true;
    while (board.sampled_period < next) {
        board.run();
        if (board.machine.control_interrupts() != interrupts) {
            board.machine.fail("two control interrupts between two samples");
        }
    }
    board.stops_at_sample = false;
}

void VirtualBoard::send(const std::string &bytes)
{
    impl_->typed += bytes;
}

bool VirtualBoard::send_frame(const can_frame &frame)
{
    return impl_->device.can().send(frame);
}

std::vector<can_frame> VirtualBoard::take_frames()
{
    return impl_->device.can().take_output();
}

/*
 * A line takes longer than a period. What is to arrive in this one began as much earlier: bytes
 * whose time has passed come at once, back to back, the others at their pace.
 */
void VirtualBoard::Impl::send_typed()
{
    if (typed.empty()) {
        return;
    }
    const Ticks byte_time = device.serial_line().byte_time();
    const Ticks last = std::max(machine.now(), sampled_at + share_of_period(arrival_in_period));
    device.serial_line().send(last - typed.size() * byte_time, typed);
    typed.clear();
}

void VirtualBoard::power_cycle()
{
    Impl &board = *impl_;
    board.hash_before = drive_hash();
    board.hash = 0;
    board.period = 0;
    board.typed.clear();
    board.computed = {};
    board.sampled_period = -1;
    board.machine.power_on();
}

void VirtualBoard::short_circuit(int leg, double current_A)
{
    Impl &board = *impl_;
    const Ticks at =
        std::max(board.machine.now(), board.sampled_at + board.share_of_period(short_in_period));
    board.device.power_stage().short_circuit(at, leg, current_A);
    const double current_range_A = board.facts.current_A_per_code * board.facts.current_zero_code;
    if (current_A > sil::comparator_trip_A(current_range_A)) {
        board.machine.schedule(board.trip_check, at + opening_time);
    }
}

void VirtualBoard::stall_control_interrupt(double until_s)
{
    Impl &board = *impl_;
    const auto end = static_cast<Ticks>(until_s * static_cast<double>(ticks_per_s));
    if (end > stall_in_period) {
        board.stall_end = board.sampled_at + end;
        board.machine.schedule(board.stall, board.sampled_at + stall_in_period);
    }
    if (end > board.deadline()) {
        board.machine.schedule(board.deadline_check,
                               board.sampled_at + board.deadline() + opening_time);
    }
}

const drive_signals &VirtualBoard::signals() const
{
    return impl_->signals;
}

std::uint64_t VirtualBoard::drive_hash() const
{
    return impl_->hash_before + impl_->hash;
}

plant::Plant &VirtualBoard::plant()
{
    return impl_->device.power_stage().plant();
}

const hal_facts &VirtualBoard::facts() const
{
    return impl_->facts;
}

std::string VirtualBoard::take_output()
{
    return impl_->device.serial_line().take_output();
}

BoardReport VirtualBoard::report() const
{
    const Machine &machine = impl_->machine;
    BoardReport report;
    report.interrupt = machine.account().summary();
    report.budget_cycles = impl_->deadline() / machine.core_cycle();
    report.stack_used_bytes = machine.stack_used();
    report.resets = machine.resets();
    report.bytes_received = impl_->device.serial_line().counters.received;
    report.bytes_sent = impl_->device.serial_line().counters.sent;
    report.flash_erases = impl_->device.flash_controller().counters().erases;
    report.flash_programs = impl_->device.flash_controller().counters().programs;
    report.simulated_s = static_cast<double>(machine.now()) / static_cast<double>(ticks_per_s);
    return report;
}

namespace
{

std::shared_ptr<const ImageFiles> image_of_this_board(const std::string &image_file)
{
    std::shared_ptr<const ImageFiles> files = read_image(image_file);
    if (files->map.core != "m4f") {
        throw std::invalid_argument(image_file + ": is for a core " + files->map.core +
                                    "; the virtual board of scenarios is the STM32G474, m4f");
    }
    return files;
}

} // namespace

std::string VirtualBoard::numeric_of(const std::string &image_file)
{
    return image_of_this_board(image_file)->map.numeric;
}

void VirtualBoard::require(const std::string &image_file, const plant::Config &plant,
                           const std::string &numeric)
{
    require_image_facts(plant, image_of_this_board(image_file)->map, numeric);
}

Machine &VirtualBoard::machine()
{
    return impl_->machine;
}

Stm32g474Device &VirtualBoard::device()
{
    return impl_->device;
}

} // namespace virtual_board
