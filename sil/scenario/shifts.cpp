#include "sil/scenario/shifts.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sil/board/board.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

using Coefficients = std::vector<std::pair<std::string, double>>;

/* A mantissa is below 2^15; of these, two bits are room. */
constexpr int room_bits = 2;

/* The largest magnitude of each name, in the order of the drive. */
Coefficients largest(const Coefficients &all)
{
    Coefficients out;
    for (const auto &[name, value] : all) {
        const auto same = std::find_if(
            out.begin(), out.end(), [&name = name](const auto &row) { return row.first == name; });
        if (same == out.end()) {
            out.emplace_back(name, std::abs(value));
        } else {
            same->second = std::max(same->second, std::abs(value));
        }
    }
    return out;
}

int shift_of(double magnitude)
{
    int exponent = 0;
    std::frexp(magnitude, &exponent);
    return magnitude == 0 ? 0 : std::max(exponent + 1 + room_bits, -31);
}

} // namespace

std::string coefficient_shifts(const Scenario &scenario)
{
    if (scenario.drive.feedback != DRIVE_FEEDBACK_SENSORLESS ||
        scenario.drive.estimator != DRIVE_ESTIMATOR_INVARIANT_EKF ||
        (scenario.drive.law != POSITION_LAW_STATE_FEEDBACK &&
         scenario.drive.law != POSITION_LAW_PID)) {
        throw InputError(scenario.name +
                         ": an image for one motor is for feedback sensorless, estimator "
                         "invariant-ekf, and law state-feedback or pid");
    }
    const sil::Board board(scenario.plant, firmware_image_fixed, scenario.drive);
    std::string command = "steadystep-sil shifts " + scenario.asked;
    if (!scenario.given.parameters.empty()) {
        command += " --parameters " + scenario.given.parameters;
    }
    for (const std::string &setting : scenario.given.settings) {
        command += " --set " + setting;
    }
    std::string text =
        "/* Shifts of an image for one motor (firmware/numeric/coefficients.h), and the "
        "largest such\n   coefficient. Written by\n   " +
        command + " */\n";
    const Coefficients rows = largest(board.coefficients());
    std::size_t widest = 0;
    for (const auto &[name, magnitude] : rows) {
        widest = std::max(widest, name.size());
    }
    for (const auto &[name, magnitude] : rows) {
        const std::string shift = format("(%d)", shift_of(magnitude));
        text += format("#define COEF_SHIFT_%-*s %-5s /* %.4g */\n", int(widest), name.c_str(),
                       shift.c_str(), magnitude);
    }
    return text;
}

} // namespace scenario
