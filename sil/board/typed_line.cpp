#include "sil/board/typed_line.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "firmware/interface/dictionary.h"

namespace sil
{

std::string typed_line(const drive_command &command, std::optional<std::uint32_t> at_period)
{
    std::string line = drive_command_name(command.kind);
    const parameter_row *parameter = nullptr;
    for (std::size_t i = 0; (parameter = parameter_of(command.kind, i)) != nullptr; ++i) {
        char number[40];
        std::snprintf(number, sizeof number, "%a", parameter_get(&command, parameter));
        line += std::string(" ") + parameter->name + "=" + number;
    }
    return at_period ? line + " at=" + std::to_string(*at_period) : line;
}

std::uint32_t typed_delay(drive_command_kind kind, double control_period_s)
{
    if (drive_command_is(kind, DRIVE_AT_ONCE)) {
        return 0;
    }
    const bool planned = drive_command_is(kind, DRIVE_AHEAD);
    const double lead = std::floor(DRIVE_LEAD_s / control_period_s + 0.5);
    return drive_typed_delay_periods(control_period_s) +
           (planned ? static_cast<std::uint32_t>(std::max(lead, 3.0)) : 0);
}

} // namespace sil
