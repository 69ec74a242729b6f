#include "sil/serve/knobs.h"

#include <stdexcept>
#include <utility>

#include "firmware/interface/drive_interface.h"
#include "sil/scenario/text.h"
#include "sil/scenario/timeline.h"

namespace serve
{

namespace
{

constexpr std::size_t longest_line = 1000;

std::string without_blanks(const std::string &line)
{
    const std::size_t begin = line.find_first_not_of(" \t\r");
    return begin == std::string::npos
               ? ""
               : line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin);
}

} // namespace

Knobs::Knobs(const scenario::Scenario &scenario, sil::DriveBoard &board)
    : scenario_(scenario), board_(board), events_(scenario, board)
{
}

std::string Knobs::state(std::uint32_t n) const
{
    const plant::State &motor = board_.plant().state();
    const drive_signals &drive = board_.signals();
    return scenario::format(
        "ok time_s=%.4f theta_rad=%.9g omega_rad_s=%.6g load_torque_Nm=%.6g i_a_A=%.5g i_b_A=%.5g "
        "bus_V=%.5g state=%s fault=%s outputs=%u\n",
        n * scenario_.plant.bridge.period_s, motor.theta_rad, motor.omega_rad_s,
        motor.load_torque_Nm, motor.i_a_A, motor.i_b_A, motor.bus_V, drive_state_name(drive.state),
        drive_fault_name(drive.fault), board_.machine_outputs());
}

std::string Knobs::obey(const std::string &line, std::uint32_t n)
{
    if (line == "state") {
        return state(n);
    }
    try {
        const scenario::Event event = scenario::read_knob(line, "knob");
        if (event.power_cycle) {
            board_.power_cycle();
            restarted_ = true;
        } else {
            events_.act(event, n);
        }
    } catch (const std::invalid_argument &refusal) { /* of the plant */
        return "error: " + scenario::in_one_line(refusal.what()) + "\n";
    } catch (const scenario::InputError &error) {
        return "error: " + scenario::in_one_line(error.what()) + "\n";
    }
    return scenario::format("ok time_s=%.4f\n", n * scenario_.plant.bridge.period_s);
}

std::string Knobs::turn(const std::string &bytes, std::uint32_t n)
{
    std::string answers;
    for (const char character : bytes) {
        if (character != '\n') {
            line_ += line_.size() < longest_line ? std::string(1, character) : "";
            continue;
        }
        const std::string line = without_blanks(line_);
        line_.clear();
        answers += line.empty() ? "" : obey(line, n);
    }
    return answers;
}

void Knobs::act(std::uint32_t n)
{
    events_.go_on(n);
}

bool Knobs::take_restart()
{
    return std::exchange(restarted_, false);
}

} // namespace serve
