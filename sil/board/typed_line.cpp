#include "sil/board/typed_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace sil
{

namespace
{

struct Parameter {
    const char *name;
    double drive_command::*value;
};

const Parameter position = {"position_rad", &drive_command::position_rad};
const Parameter duration = {"duration_s", &drive_command::duration_s};
const Parameter ramp = {"ramp_s", &drive_command::ramp_s};
const Parameter jerk_time = {"jerk_s", &drive_command::jerk_s};
const Parameter amplitude = {"amplitude_rad", &drive_command::amplitude_rad};
const Parameter frequency = {"frequency_Hz", &drive_command::frequency_Hz};
const Parameter cycles = {"cycles", &drive_command::cycles};
const Parameter interval = {"interval_s", &drive_command::interval_s};
const Parameter speed = {"speed_rad_s", &drive_command::speed_rad_s};
const Parameter acceleration = {"acceleration_rad_s2", &drive_command::acceleration_rad_s2};
const Parameter jerk = {"jerk_rad_s3", &drive_command::jerk_rad_s3};

struct Form {
    const char *name;
    std::vector<Parameter> parameters;
};

Form form_of(drive_command_kind kind)
{
    switch (kind) {
    case DRIVE_COMMAND_ENABLE:
        return {"enable", {}};
    case DRIVE_COMMAND_DISABLE:
        return {"disable", {}};
    case DRIVE_COMMAND_HOLD:
        return {"hold", {}};
    case DRIVE_COMMAND_MOVE_TRAPEZOID:
        return {"move-trapezoid", {position, duration, ramp}};
    case DRIVE_COMMAND_MOVE_SMOOTH:
        return {"move-smooth", {position, duration, ramp, jerk_time}};
    case DRIVE_COMMAND_STEP:
        return {"step", {position}};
    case DRIVE_COMMAND_STOP:
        return {"stop", {}};
    case DRIVE_COMMAND_SINE:
        return {"sine", {amplitude, frequency, cycles, ramp}};
    case DRIVE_COMMAND_SET_POINT:
        return {"set-point", {position, interval, acceleration, jerk}};
    case DRIVE_COMMAND_VELOCITY:
        return {"velocity", {speed, acceleration, jerk}};
    case DRIVE_COMMAND_RETARGET:
        return {"retarget", {position, speed, acceleration, jerk}};
    default:
        return {"save", {}};
    }
}

} // namespace

std::string typed_line(const drive_command &command, std::optional<std::uint32_t> at_period)
{
    const Form form = form_of(command.kind);
    std::string line = form.name;
    for (const Parameter &parameter : form.parameters) {
        char number[40];
        std::snprintf(number, sizeof number, "%a", command.*parameter.value);
        line += std::string(" ") + parameter.name + "=" + number;
    }
    return at_period ? line + " at=" + std::to_string(*at_period) : line;
}

std::uint32_t typed_delay(drive_command_kind kind, double control_period_s)
{
    if (kind == DRIVE_COMMAND_SAVE) {
        return 0;
    }
    const bool planned = kind >= DRIVE_COMMAND_SINE && kind <= DRIVE_COMMAND_RETARGET;
    const double lead = std::floor(DRIVE_LEAD_s / control_period_s + 0.5);
    return DRIVE_TYPED_DELAY_PERIODS +
           (planned ? static_cast<std::uint32_t>(std::max(lead, 3.0)) : 0);
}

} // namespace sil
