#include "sil/scenario/record.h"

#include <cmath>
#include <cstring>

namespace scenario
{

const char *column_name(Column column)
{
    static const char *const names[COLUMNS] = {
        "theta_ref_rad",
        "theta_rad",
        "theta_est_rad",
        "omega_ref_rad_s",
        "omega_rad_s",
        "omega_est_rad_s",
        "load_torque_Nm",
        "load_torque_est_Nm",
        "i_a_A",
        "i_b_A",
        "u_a_V",
        "u_b_V",
        "i_d_A",
        "i_q_A",
        "i_d_ref_A",
        "i_q_ref_A",
        "u_d_V",
        "u_q_V",
        "resistance_ohm",
        "resistance_est_ohm",
        "bus_V",
        "drive_state",
        "drive_fault",
        "holding",
        "reference_moving",
        "synchronism",
    };
    return names[column];
}

void Record::append(const Row &row)
{
    constexpr std::uint64_t prime = 0x100000001b3u;
    constexpr std::uint64_t any_nan = 0x7ff8000000000000u;
    for (const double value : row) {
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        hash_ = (hash_ ^ (value == value ? bits : any_nan)) * prime;
    }
    rows_.push_back(row);
}

double time_of(double periods, double period_s)
{
    /* Divided by 10 kHz it is the number nearest to the decimal; multiplied by 1e-4 it may not. */
    const double rate_Hz = std::floor(1 / period_s + 0.5);
    const double misfit = rate_Hz * period_s - 1;
    return std::fabs(misfit) < 1e-12 ? periods / rate_Hz : periods * period_s;
}

double Record::time_s(std::size_t row) const
{
    return time_of(static_cast<double>(row) - static_cast<double>(time_zero_row_), period_s_);
}

} // namespace scenario
