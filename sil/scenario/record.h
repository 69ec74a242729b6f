/*
 * What a run leaves behind: every signal of every period, hashed as it comes and handed to whoever
 * reads it; nothing is kept, so that a run of any length fits into memory. Values of row k belong
 * to S(k). True values come from the plant, `_est` and `_ref` from the drive.
 */
#ifndef STEADYSTEP_SCENARIO_RECORD_H
#define STEADYSTEP_SCENARIO_RECORD_H

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "firmware/interface/dictionary.h"

namespace scenario
{

/* In the order of a trace: signals of the drive (firmware/interface/signals_table.h), and what is
   true, in the plant. The drive's traced signals that do not stand here follow. */
#define TRACE_COLUMNS(DRIVE, TRUE, RENAMED)                                                        \
    DRIVE(THETA_REF, theta_ref_rad)                                                                \
    TRUE(THETA, theta_rad)                                                                         \
    DRIVE(THETA_EST, theta_est_rad)                                                                \
    DRIVE(OMEGA_REF, omega_ref_rad_s)                                                              \
    TRUE(OMEGA, omega_rad_s)                                                                       \
    DRIVE(OMEGA_EST, omega_est_rad_s)                                                              \
    TRUE(LOAD_TORQUE, load_torque_Nm)                                                              \
    DRIVE(LOAD_TORQUE_EST, load_torque_est_Nm)                                                     \
    TRUE(I_A, i_a_A)                                                                               \
    TRUE(I_B, i_b_A)                                                                               \
    TRUE(U_A, u_a_V) /* phase voltages: means over S(k-1)...S(k) */                                \
    TRUE(U_B, u_b_V)                                                                               \
    DRIVE(I_D, i_d_A)                                                                              \
    DRIVE(I_Q, i_q_A)                                                                              \
    DRIVE(I_D_REF, i_d_ref_A)                                                                      \
    DRIVE(I_Q_REF, i_q_ref_A)                                                                      \
    DRIVE(U_D, u_d_V)                                                                              \
    DRIVE(U_Q, u_q_V)                                                                              \
    TRUE(RESISTANCE, resistance_ohm)                                                               \
    DRIVE(RESISTANCE_EST, resistance_est_ohm)                                                      \
    TRUE(BUS, bus_V)                                                                               \
    /* of an enumeration: a number, so that a plotter can draw it */                               \
    RENAMED(DRIVE_STATE, state, drive_state)                                                       \
    RENAMED(DRIVE_FAULT_CODE, fault, drive_fault)                                                  \
    DRIVE(HOLDING, holding)                                                                        \
    DRIVE(REFERENCE_MOVING, reference_moving)                                                      \
    DRIVE(SYNCHRONISM, synchronism)

#define TRACED(index, member, path, brief, traced, ...) SIGNAL_IS_##traced,
#define COLUMN(column, ...)                             column,
#define IS_OF_DRIVE(column, ...)                        1,
#define IS_TRUE(column, ...)                            0,
template <std::size_t Length> constexpr std::size_t sum(const int (&ones)[Length])
{
    std::size_t all = 0;
    for (const int one : ones) {
        all += static_cast<std::size_t>(one);
    }
    return all;
}
enum Column : std::size_t {
    TRACE_COLUMNS(COLUMN, COLUMN, COLUMN) NAMED_COLUMNS,
    COLUMNS = NAMED_COLUMNS + sum({DRIVE_SIGNALS_TABLE(TRACED, TRACED, TRACED, TRACED, TRACED)}) -
              sum({TRACE_COLUMNS(IS_OF_DRIVE, IS_TRUE, IS_OF_DRIVE)})
};
#undef TRACED
#undef COLUMN
#undef IS_OF_DRIVE
#undef IS_TRUE

/* Name with unit, as a trace heads the column. */
const char *column_name(Column column);

/* Of a number of periods; the number nearest to the decimal where the rate is one of whole Hz. */
double time_of(double periods, double period_s);

using Row = std::array<double, COLUMNS>;

/* What the drive shows. */
void put_signals(Row &row, const drive_signals &signals);

class Record;

/* Takes the rows of a record, one after another. */
class RowReader
{
  public:
    virtual ~RowReader() = default;
    /* Row number record.rows(); the record knows its time zero by now. */
    virtual void read(const Record &record, const Row &row) = 0;
};

class Record
{
  public:
    explicit Record(double period_s) : period_s_(period_s)
    {
    }

    /* Before the first row; the reader outlives the record. */
    void add_reader(RowReader &reader)
    {
        readers_.push_back(&reader);
    }
    void append(const Row &row);
    /* The next row to be appended is S(k0), time 0. Rows before it show the enabling; they wait
       here until this moment, because only then their times are known. */
    void start_time_here();
    /* No row follows. Those of an enabling that has never ended count from the first. */
    void end();

    double period_s() const
    {
        return period_s_;
    }
    std::size_t rows() const /* that have been read */
    {
        return rows_;
    }
    std::size_t time_zero_row() const
    {
        return time_zero_row_;
    }
    double time_s(std::size_t row) const;

    /* FNV-1a over the bits of all values, 64 bits at a time; every NaN counts alike. */
    std::uint64_t hash() const
    {
        return hash_;
    }

  private:
    void pass_on(const Row &row);
    void pass_on_waiting();

    double period_s_;
    std::vector<RowReader *> readers_;
    std::vector<Row> waiting_; /* until time zero is known */
    bool started_ = false;
    std::size_t rows_ = 0, time_zero_row_ = 0;
    std::uint64_t hash_ = 0xcbf29ce484222325u;
};

} // namespace scenario

#endif
