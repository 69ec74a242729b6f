/* Homing through CANopen in closed loop: a machine with hard stops, and all motors on it. */
#ifndef STEADYSTEP_HOMING_BENCH_H
#define STEADYSTEP_HOMING_BENCH_H

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <unity.h>

#include "sil/board/board.h"
#include "sil/scenario/catalogue.h"
#include "sil/scenario/number_formats.h"
#include "sil/scenario/runner.h"
#include "sil/scenario/scenario_file.h"
#include "sil/scenario/text.h"

namespace homing
{

constexpr double stop_rad = 1.0;
constexpr double pi = 3.14159265358979323846;
constexpr unsigned reached = 0x0400, attained = 0x1000, failed = 0x2000, homing_bits = 0x3400;

/* What is asked of a machine. */
struct Case {
    std::string motor, numeric = "float", more;
    int method = -2;
    double load = 0;               /* against the motion, of the rated torque */
    double stiffness_Nm_rad = 100; /* of a stop each way; 0: there are none */
    unsigned travel = 65536;       /* object 2403h, 2 */
    double stiffness_rated = 0;    /* at least so many times the rated torque over a full step */
    double speed = 0;              /* object 6099h, 1, of V / Km; 0: its default */
    unsigned seed = 1;             /* of the noise and of how the parts are built */
    scenario::MachineSwitches switches{}; /* one of them changes at stop_rad */

    bool has_place() const
    {
        return stiffness_Nm_rad > 0 || switches.wired != 0;
    }
};

struct Outcome {
    unsigned status = 0;
    double off_rad = 0; /* the axis, of where the stop makes it */
    double full_step_rad = 0;
    double yields_rad = 0; /* the stop, under the torque that is a stop's */
};

class Machine
{
  public:
    explicit Machine(const Case &asked) : asked_(asked)
    {
        const std::string text = "description = \"homing\"\nmotor = \"" + asked.motor +
                                 "\"\nduration_s = 1\nplant.model = \"as-built\"\n" + asked.more;
        const scenario::Scenario machine =
            scenario::read_scenario_text(scenario::Catalogue({}, {}), text, "homing", {});
        plant::Config plant = scenario::plant_of(machine, asked.seed);
        const motor_params &motor = machine.drive.motor;
        rated_Nm_ = motor.rated_current_A * motor.torque_constant_Nm_A;
        full_step_rad_ = pi / 2 / motor.rotor_teeth;
        speed_units_ = asked.speed * motor.supply_V / motor.torque_constant_Nm_A * 65536 / (2 * pi);
        if (asked.stiffness_Nm_rad > 0) {
            plant.stops.low_rad = -stop_rad;
            plant.stops.high_rad = stop_rad;
            plant.stops.stiffness_Nm_rad = std::fmax(
                asked.stiffness_Nm_rad, asked.stiffness_rated * rated_Nm_ / full_step_rad_);
            yields_rad_ = 0.7 * rated_Nm_ / plant.stops.stiffness_Nm_rad;
        }
        board_ = sil::Board::flashed(plant, *scenario::image_of(asked.numeric), machine.drive,
                                     machine.comparator_trip_A);
    }

    Outcome homing()
    {
        say("O");
        say("t00020101");
        put(0x6060, 0, 1, 6);
        put(0x6098, 0, 1, static_cast<unsigned>(asked_.method) & 0xffu);
        put(0x2403, 2, 4, asked_.travel);
        if (asked_.speed > 0) {
            put(0x6099, 1, 4, static_cast<unsigned>(speed_units_));
        }
        if (asked_.switches.wired != 0) { /* a look's way is the error */
            put(0x6099, 2, 4, static_cast<unsigned>(speed_units_ / 4));
        }
        put(0x6040, 0, 2, 0x06);
        put(0x6040, 0, 2, 0x0f);
        run_until(0x6f, 0x27, 60000);
        const double way = asked_.method == -1 ? -1.0 : 1.0;
        board_->plant().set_load_torque(way * asked_.load * rated_Nm_, 0.2);
        run(4000);
        put(0x6040, 0, 2, 0x1f);
        run(200);
        run_until(reached, reached, 300000);
        Outcome outcome;
        outcome.status = status_;
        outcome.off_rad =
            board_->signals().theta_ref_rad - (board_->plant().state().theta_rad - way * stop_rad);
        outcome.full_step_rad = full_step_rad_;
        outcome.yields_rad = yields_rad_;
        return outcome;
    }

    /* On the index, both ways: where the axis has the motor's zero. */
    struct Place {
        unsigned status = 0;
        double zero_rad = 0;
        double off_counts = 0; /* the axis, of where the index makes it */
    };
    Place at_index(int method)
    {
        const int offset = 3000;
        say("O");
        say("t00020101");
        put(0x6060, 0, 1, 6);
        put(0x6098, 0, 1, static_cast<unsigned>(method));
        put(0x607c, 0, 4, offset);
        put(0x6099, 1, 4, 65536);
        put(0x6040, 0, 2, 0x06);
        put(0x6040, 0, 2, 0x0f);
        run_until(0x6f, 0x27, 60000);
        put(0x6040, 0, 2, 0x1f);
        run(200);
        run_until(reached, reached, 60000);
        put(0x6040, 0, 2, 0x0f);
        const plant::SensorConfig sensors;
        const double count_rad = 2 * pi / counts_per_turn;
        const double from_index_rad = board_->plant().state().theta_rad - sensors.encoder_index_rad;
        const double shown_rad = board_->signals().theta_est_rad - offset * 2 * pi / 65536;
        return {status_, board_->signals().motor_zero_rad,
                std::remainder(shown_rad - from_index_rad, 2 * pi) / count_rad};
    }
    static constexpr int counts_per_turn = 4000;

  private:
    void period()
    {
        if (const std::uint32_t wired = asked_.switches.wired) {
            board_->put_inputs((HAL_INPUTS & ~wired) |
                               asked_.switches.active(board_->plant().state().theta_rad));
        }
        board_->control();
        heard_ += board_->take_output();
        for (std::size_t at; (at = heard_.find('\r')) != std::string::npos;) {
            const std::size_t frame = heard_.substr(0, at).rfind("t1812");
            if (frame != std::string::npos) { /* the statusword, on change */
                const auto word =
                    static_cast<unsigned>(std::stoul(heard_.substr(frame + 5, 4), nullptr, 16));
                status_ = word >> 8 | (word & 0xffu) << 8;
            }
            heard_.erase(0, at + 1);
        }
        board_->advance();
    }

    void run(int periods)
    {
        for (int k = 0; k < periods; k++) {
            period();
        }
    }

    void run_until(unsigned mask, unsigned value, int periods)
    {
        for (int k = 0; k < periods && (status_ & mask) != value && (status_ & 0x4f) != 0x08; k++) {
            period();
        }
    }

    void say(const std::string &frame)
    {
        board_->send(frame + "\r");
        run(20);
    }

    void put(unsigned index, unsigned sub, unsigned bytes, unsigned value)
    {
        say(scenario::format("t6018%02X%02X%02X%02X%02X%02X%02X%02X", 0x23u | (4u - bytes) << 2,
                             index & 255u, index >> 8, sub, value & 255u, value >> 8 & 255u,
                             value >> 16 & 255u, value >> 24));
    }

    Case asked_;
    std::unique_ptr<sil::Board> board_;
    std::string heard_;
    unsigned status_ = 0;
    double rated_Nm_ = 0, full_step_rad_ = 0, speed_units_ = 0, yields_rad_ = 0;
};

/* All of the library, if the program is asked for it; else every fourth motor, one of the strongest
   among them, to which a stop of steel is soft. Under a sanitizer all
   takes ten times as long: every eighth motor, and nothing is counted. */
inline bool whole_library = false;
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif
#else
constexpr bool sanitized = false;
#endif

inline std::vector<std::string> library()
{
    std::vector<std::string> names;
    const int one_of = sanitized ? 8 : whole_library ? 1 : 4;
    int place = 0;
    for (const std::filesystem::path &file : scenario::Catalogue({}, {}).motors()) {
        if (place++ % one_of == one_of / 4) {
            names.push_back(file.stem().string());
        }
    }
    return names;
}

struct Counts {
    int asked = 0, homed = 0, elsewhere = 0, faults = 0;
    double least_mrad = 1e9, most_mrad = -1e9;
};

/* Of the motors that the board can drive. A stop is found within a half of a full step, and what it
   yields; a switch within three quarters, as the rotor creeps and is not pressed. */
inline Counts homing_of_all(Case asked)
{
    Counts counts;
    for (const std::string &motor : library()) {
        asked.motor = motor;
        std::unique_ptr<Machine> machine;
        try {
            machine = std::make_unique<Machine>(asked);
        } catch (const std::exception &) {
            continue; /* another board's */
        }
        const Outcome outcome = machine->homing();
        const bool homed = (outcome.status & homing_bits) == (reached | attained);
        const double within_steps = asked.switches.wired != 0 ? 0.75 : 0.55;
        const bool elsewhere =
            homed &&
            (!asked.has_place() || std::fabs(outcome.off_rad) >
                                       within_steps * outcome.full_step_rad + outcome.yields_rad);
        counts.asked++;
        counts.homed += homed;
        counts.elsewhere += elsewhere;
        counts.faults += (outcome.status & 0x4f) == 0x08;
        if (homed) {
            counts.least_mrad = std::fmin(counts.least_mrad, 1e3 * outcome.off_rad);
            counts.most_mrad = std::fmax(counts.most_mrad, 1e3 * outcome.off_rad);
        }
        if (asked.has_place() ? !homed || elsewhere : homed) {
            std::printf("  %s: %04x, %.1f mrad\n", motor.c_str(), outcome.status,
                        1e3 * outcome.off_rad);
        }
    }
    std::printf("%s, method %d, load %.2f, %g N m/rad%s: of %d homed %d, %.1f...%.1f mrad, "
                "elsewhere %d, in fault %d\n",
                asked.numeric.c_str(), asked.method, asked.load, asked.stiffness_Nm_rad,
                asked.switches.wired != 0 ? ", switches"
                : asked.more.empty()      ? ""
                                          : ", encoder",
                counts.asked, counts.homed, counts.least_mrad, counts.most_mrad, counts.elsewhere,
                counts.faults);
    return counts;
}

inline void begin(int argc, char **argv)
{
    whole_library = argc > 1 && std::string(argv[1]) == "all";
    UNITY_BEGIN();
}

/* At least so many of the whole library, and of its every fourth. */
struct Least {
    int of_all, of_some;
    int faults = 1; /* at most, of the others */
};

inline void expect_homed(const Case &asked, Least least)
{
    const Counts counts = homing_of_all(asked);
    TEST_ASSERT_EQUAL(0, counts.elsewhere);
    TEST_ASSERT_GREATER_OR_EQUAL(sanitized       ? 0
                                 : whole_library ? least.of_all
                                                 : least.of_some,
                                 counts.homed);
    TEST_ASSERT_LESS_OR_EQUAL(least.faults, counts.faults);
}

} // namespace homing

#endif
