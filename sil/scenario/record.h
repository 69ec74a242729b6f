/*
 * What a run leaves behind: every signal of every period, in memory, hashed as it comes. Values of
 * row k belong to S(k). True values come from the plant, `_est` and `_ref` from the drive.
 */
#ifndef STEADYSTEP_SCENARIO_RECORD_H
#define STEADYSTEP_SCENARIO_RECORD_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace scenario
{

enum Column : std::size_t {
    THETA_REF,
    THETA,
    THETA_EST,
    OMEGA_REF,
    OMEGA,
    OMEGA_EST,
    LOAD_TORQUE,
    LOAD_TORQUE_EST,
    I_A,
    I_B,
    U_A, /* phase voltages: means over S(k-1)...S(k) */
    U_B,
    I_D,
    I_Q,
    I_D_REF,
    I_Q_REF,
    U_D,
    U_Q,
    RESISTANCE,
    RESISTANCE_EST,
    BUS,
    DRIVE_STATE, /* drive_state and drive_fault as numbers, so that a plotter can draw them */
    DRIVE_FAULT_CODE,
    HOLDING,
    REFERENCE_MOVING,
    SYNCHRONISM, /* drive_synchronism, likewise */
    COLUMNS
};

/* Name with unit, as trace.csv heads the column. */
const char *column_name(Column column);

/* Of a number of periods; the number nearest to the decimal where the rate is one of whole Hz. */
double time_of(double periods, double period_s);

using Row = std::array<double, COLUMNS>;

class Record
{
  public:
    explicit Record(double period_s) : period_s_(period_s)
    {
    }

    void reserve(std::size_t rows)
    {
        rows_.reserve(rows);
    }
    void append(const Row &row);
    /* The next row to be appended is S(k0), time 0; rows before it show the enabling. */
    void start_time_here()
    {
        time_zero_row_ = rows_.size();
    }

    double period_s() const
    {
        return period_s_;
    }
    std::size_t rows() const
    {
        return rows_.size();
    }
    std::size_t time_zero_row() const
    {
        return time_zero_row_;
    }
    double time_s(std::size_t row) const;
    const Row &row(std::size_t row) const
    {
        return rows_[row];
    }
    double at(std::size_t row, Column column) const
    {
        return rows_[row][column];
    }

    /* FNV-1a over the bits of all values, 64 bits at a time; every NaN counts alike. */
    std::uint64_t hash() const
    {
        return hash_;
    }

  private:
    double period_s_;
    std::size_t time_zero_row_ = 0;
    std::vector<Row> rows_;
    std::uint64_t hash_ = 0xcbf29ce484222325u;
};

} // namespace scenario

#endif
