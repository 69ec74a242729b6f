#include "sil/scenario/runner.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "sil/board/typed_line.h"
#include "sil/scenario/interruption.h"
#include "sil/scenario/plant_events.h"
#include "sil/scenario/serial_line.h"
#include "sil/scenario/tape.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr double longest_enabling_s = 60;

std::uint32_t periods(double time_s, double period_s)
{
    return static_cast<std::uint32_t>(std::floor(time_s / period_s + 0.5));
}

/* Whether the reference moves more slowly than a drive sees for a tenth of a second, all ramps
   together. */
class Creep : public RowReader
{
  public:
    explicit Creep(double blind_speed_rad_s) : blind_speed_rad_s_(blind_speed_rad_s)
    {
    }

    void read(const Record &record, const Row &row) override
    {
        const double speed = std::fabs(row[OMEGA_REF]);
        if (record.rows() >= record.time_zero_row() && speed > 0 && speed < blind_speed_rad_s_) {
            time_s_ += record.period_s();
        }
    }
    std::optional<double> blind_below_rad_s() const
    {
        return time_s_ >= 0.1 ? std::optional<double>(blind_speed_rad_s_) : std::nullopt;
    }

  private:
    double blind_speed_rad_s_, time_s_ = 0;
};

/* Steps a board through its timeline and writes the record. */
class Runner
{
  public:
    /* `direct`: the same board, to which commands are posted past the serial line; nullptr: they
       are typed. */
    Runner(const Scenario &scenario, sil::DriveBoard &board, sil::Board *direct, Record &record)
        : scenario_(scenario), board_(board), direct_(direct), record_(record),
          period_s_(scenario.plant.bridge.period_s), plant_events_(scenario, board),
          creep_(drive_blind_speed_rad_s(&scenario.drive, &board.facts())), line_(board),
          tape_(scenario.events, period_s_)
    {
        record_.add_reader(creep_);
    }

    Run run()
    {
        const std::uint32_t last = periods(scenario_.duration_s, period_s_);
        try {
            if (enable()) {
                follow_timeline(last);
            }
        } catch (const std::invalid_argument &refusal) {
            result_.failure = refusal.what();
        } catch (const std::runtime_error &failure) { /* of a board that the firmware misuses */
            result_.failure = failure.what();
        }
        record_.end();
        result_.drive_hash = board_.drive_hash();
        result_.blind_below_rad_s = creep_.blind_below_rad_s();
        result_.serial = line_.transcript();
        add_refused_lines();
        return std::move(result_);
    }

  private:
    void control()
    {
        throw_if_interrupted();
        board_.control();
        line_.listen();
    }

    void ask_for_enabling()
    {
        drive_command command{};
        command.kind = DRIVE_COMMAND_ENABLE;
        if (direct_ != nullptr) {
            direct_->command(command);
        } else {
            line_.type(sil::typed_line(command), "enabling", 0);
        }
    }

    /* Leaves the board at S(k0), the control interrupt done: the first period it is ready. */
    bool enable()
    {
        ask_for_enabling();
        stood_at_rad_ = board_.plant().state().theta_rad;
        const std::uint32_t last = periods(longest_enabling_s, period_s_);
        std::uint32_t begin = 0; /* of enabling: a typed command takes some periods to act */
        for (std::uint32_t k = 0;; ++k) {
            control();
            const drive_state state = board_.signals().state;
            if (state == DRIVE_SWITCH_ON_DISABLED) {
                begin = k + 1;
            }
            if (state == DRIVE_OPERATION_ENABLED) {
                result_.enabling_time_s = (k - begin) * period_s_;
                return wait_for_time_zero(k);
            }
            if (!line_.refusals().empty()) {
                result_.failure = reason_of(line_.refusals().front());
                return false;
            }
            if (state == DRIVE_FAULT || k == last) {
                result_.failure = format("the drive did not become ready: %s after %g s, fault %s",
                                         drive_state_name(state), k * period_s_,
                                         drive_fault_name(board_.signals().fault));
                return false;
            }
            pass_enabling(k);
        }
    }

    void record_enabling(std::uint32_t k)
    {
        if (scenario_.record_enabling) {
            record(k);
        }
    }

    void pass_enabling(std::uint32_t k)
    {
        record_enabling(k);
        board_.advance();
        result_.enabling_displacement_rad =
            std::fabs(board_.plant().state().theta_rad - stood_at_rad_);
        result_.enabling_motion_max_rad =
            std::max(result_.enabling_motion_max_rad, result_.enabling_displacement_rad);
    }

    /* Commands are posted in their own period, but typed before it. */
    bool wait_for_time_zero(std::uint32_t k)
    {
        const std::uint32_t shift = direct_ != nullptr ? 0 : typed_shift(period_s_);
        time_zero_ = board_.signals().period + shift;
        for (std::uint32_t n = 1; n <= shift; ++n) {
            record_enabling(k + n - 1);
            board_.advance();
            tape_.type(std::int64_t{n} - shift, time_zero_, line_);
            if (n < shift) {
                control();
                watch(std::int64_t{n} - shift);
            }
        }
        result_.time_zero_s = (k + shift) * period_s_;
        return true;
    }

    void follow_timeline(std::uint32_t last)
    {
        record_.start_time_here();
        for (std::uint32_t n = 0;; ++n) {
            act(n);
            if (n > 0 || direct_ == nullptr) {
                control();
            }
            watch(n);
            record(n);
            if (n == last) {
                return;
            }
            board_.advance();
        }
    }

    /* Events of period n. A command of period 0 that is posted acts in the next interrupt: the one
       of S(k0) has found the drive ready only now. */
    void act(std::uint32_t n)
    {
        for (; next_ < scenario_.events.size() &&
               periods(scenario_.events[next_].time_s, period_s_) <= n;
             ++next_) {
            const Event &event = scenario_.events[next_];
            if (event.command) {
                post(event, n);
            } else if (event.power_cycle) {
                board_.power_cycle();
                line_.forget();
                watch_.restart();
                time_zero_ = 0u - n; /* the drive counts its periods from 0 again */
            } else if (event.type) {
                line_.type(*event.type, event.location.text(), time_of(n, period_s_));
            } else if (event.expects) {
                expect(event);
            } else {
                plant_events_.act(event, n);
            }
        }
        if (direct_ == nullptr) {
            tape_.type(n, time_zero_, line_);
        }
        stream(n);
        plant_events_.go_on(n);
    }

    void post(const Event &event, std::uint32_t n)
    {
        if (direct_ == nullptr) {
            return; /* the tape has it */
        }
        drive_command command = *event.command;
        command.at_period = time_zero_ + n;
        if (posted(command, event.location, n) && !event.set_points_rad.empty()) {
            streams_.push_back({command, &event.set_points_rad, 1, n,
                                std::max(1u, periods(command.interval_s, period_s_)),
                                event.location});
        }
    }

    /* false: the drive refuses it, and the run goes on. */
    bool posted(const drive_command &command, const Location &origin, std::uint32_t n)
    {
        try {
            direct_->command(command);
        } catch (const std::invalid_argument &refusal) {
            const std::string name = command_name(command.kind);
            result_.incidents.push_back({Incident::Kind::refused, time_of(n, period_s_), name,
                                         origin.text() + ": " + name + ": " + refusal.what()});
            return false;
        }
        return true;
    }

    static std::string reason_of(const SerialLine::Refusal &refusal)
    {
        return refusal.origin + ": " + refusal.line + ": " + refusal.answer;
    }

    /* Those whose answer no event of the timeline has expected. */
    void add_refused_lines()
    {
        std::vector<Incident> &incidents = result_.incidents;
        for (const SerialLine::Refusal &refusal : line_.refusals()) {
            if (!refusal.expected) {
                incidents.push_back(
                    {Incident::Kind::refused, refusal.time_s, refusal.line, reason_of(refusal)});
            }
        }
        std::stable_sort(incidents.begin(), incidents.end(),
                         [](const Incident &a, const Incident &b) { return a.time_s < b.time_s; });
    }

    /* After the control interrupt of period n. */
    void watch(std::int64_t n)
    {
        const double time_s = time_of(static_cast<double>(n), period_s_);
        watch_.look(board_.signals(), time_s, result_.incidents);
    }

    void expect(const Event &event)
    {
        if (!line_.expect(*event.expects)) {
            throw std::invalid_argument(event.location.text() + ": expected the drive to write \"" +
                                        *event.expects + "...\", it has written " + line_.unread());
        }
    }

    struct Stream {
        drive_command command;
        const std::vector<double> *positions_rad;
        std::size_t next; /* first position that has not been posted */
        std::uint32_t start, interval;
        Location origin;
    };

    /* The set-point of this period; the first that is refused is the last. */
    void stream(std::uint32_t n)
    {
        for (Stream &stream : streams_) {
            if (stream.next < stream.positions_rad->size() &&
                n == stream.start + stream.next * stream.interval) {
                stream.command.position_rad = (*stream.positions_rad)[stream.next++];
                if (!posted(stream.command, stream.origin, n)) {
                    stream.next = stream.positions_rad->size();
                }
            }
        }
    }

    /* Behind a set-position as well; without one the same bits. */
    double in_coordinates_of_drive(double theta_rad) const
    {
        const double zero_rad = board_.signals().motor_zero_rad;
        return zero_rad != 0 ? theta_rad + zero_rad : theta_rad;
    }

    void record(std::uint32_t period)
    {
        if (period % scenario_.record_every != 0) {
            return;
        }
        const plant::State &state = board_.plant().state();
        Row row;
        put_signals(row, board_.signals());
        row[THETA] = in_coordinates_of_drive(state.theta_rad);
        row[OMEGA] = state.omega_rad_s;
        row[LOAD_TORQUE] = state.load_torque_Nm;
        row[I_A] = state.i_a_A;
        row[I_B] = state.i_b_A;
        row[U_A] = state.u_a_V;
        row[U_B] = state.u_b_V;
        row[RESISTANCE] = plant_events_.motor().resistance_ohm +
                          scenario_.plant.imperfections.bridge_resistance_ohm;
        row[BUS] = state.bus_V;
        record_.append(row);
    }

    const Scenario &scenario_;
    sil::DriveBoard &board_;
    sil::Board *direct_;
    Record &record_;
    double period_s_;
    PlantEvents plant_events_;
    Run result_;
    Creep creep_;
    SerialLine line_;
    Tape tape_;
    DriveWatch watch_;
    double stood_at_rad_ = 0; /* the rotor, when it was enabled */
    std::uint32_t time_zero_ = 0;
    std::size_t next_ = 0; /* first event that has not acted */
    std::vector<Stream> streams_;
};

constexpr int drive_queue_length = 15;

/* The steps of enabling left out: ready at once, where the drive assumes that it stands. */
drive_settings without_enabling(drive_settings settings)
{
    settings.calibrate_offsets = false;
    settings.hold_on_enable = false;
    settings.initial_position = DRIVE_INITIAL_POSITION_ASSUMED;
    settings.standstill_pulses = false; /* they need what the impulses find */
    return settings;
}

void make_ready(sil::Board &board)
{
    drive_command enable{};
    enable.kind = DRIVE_COMMAND_ENABLE;
    board.command(enable);
    while (board.signals().state == DRIVE_SWITCH_ON_DISABLED) {
        board.control();
    }
}

/* As many as a drive takes at once: it plans a move, and may refuse it, when it is posted. What is
   refused because of the state that it finds, or starts where only the run can show, is for the
   run. */
void post_commands(sil::Board &board, const Scenario &scenario)
{
    int posted = 0;
    for (const Event &event : scenario.events) {
        if (event.power_cycle) {
            return; /* what comes then is for another drive */
        }
        if (!event.command || posted == drive_queue_length) {
            continue;
        }
        const drive_command_kind kind = event.command->kind;
        if (kind == DRIVE_COMMAND_STOP || kind == DRIVE_COMMAND_DISABLE ||
            kind == DRIVE_COMMAND_SET_POSITION) {
            return;
        }
        try {
            board.command(*event.command);
        } catch (const std::invalid_argument &refusal) {
            throw InputError(event.location.text() + ": " + refusal.what());
        }
        if (kind == DRIVE_COMMAND_SINE || kind == DRIVE_COMMAND_VELOCITY ||
            kind == DRIVE_COMMAND_SET_POINT || kind == DRIVE_COMMAND_TORQUE) {
            return;
        }
        ++posted;
    }
}

/* The plant refuses at once what it would refuse in the run. */
void disturb(plant::Plant &plant, const Scenario &scenario)
{
    PlantValues values = plant_values_of(scenario);
    for (const Event &event : scenario.events) {
        try {
            if (event.fault) {
                event.fault(plant);
            }
            for (const Drift &drift : event.drifts) {
                if (drift.field->part == PlantPart::sensors && scenario.plant.sensors.exact) {
                    throw std::invalid_argument(std::string(drift.field->key) +
                                                ": expected sensing that is not exact");
                }
                drift.field->of(values) = drift.to;
                put_plant_part(scenario, values, drift.field->part, plant);
            }
        } catch (const std::invalid_argument &refusal) {
            throw InputError(event.location.text() + ": " + refusal.what());
        }
    }
}

} // namespace

void check(const Scenario &scenario, const firmware_image &image)
{
    try {
        sil::Board(scenario.plant, image, scenario.drive);
        sil::Board board(scenario.plant, image, without_enabling(scenario.drive));
        make_ready(board);
        post_commands(board, scenario);
        disturb(board.plant(), scenario);
    } catch (const std::invalid_argument &refusal) {
        throw InputError(scenario.locate(refusal.what()) + refusal.what());
    }
}

plant::Config plant_of(const Scenario &scenario, std::uint64_t seed)
{
    plant::Config config = scenario.plant;
    config.seed = seed;
    return config;
}

std::uint32_t typed_shift(double control_period_s)
{
    return sil::typed_delay(DRIVE_COMMAND_SINE, control_period_s) + 1;
}

double row_period_s(const Scenario &scenario)
{
    return scenario.plant.bridge.period_s * scenario.record_every;
}

Run run(const Scenario &scenario, const firmware_image &image, std::uint64_t seed, Record &record)
{
    sil::Board board(plant_of(scenario, seed), image, scenario.drive, scenario.comparator_trip_A);
    return Runner(scenario, board, scenario.given.typed ? nullptr : &board, record).run();
}

Run run_typed(const Scenario &scenario, sil::DriveBoard &board, Record &record)
{
    return Runner(scenario, board, nullptr, record).run();
}

} // namespace scenario
