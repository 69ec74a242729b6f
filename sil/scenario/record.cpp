#include "sil/scenario/record.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace scenario
{

namespace
{

/* The signal in each column; none where it is of the plant. */
std::vector<const signal_row *> signals_of_columns()
{
#define OF_DRIVE(column, member, ...) signal_at(SIGNAL_##member),
#define OF_PLANT(column, name)        nullptr,
    std::vector<const signal_row *> columns = {TRACE_COLUMNS(OF_DRIVE, OF_PLANT, OF_DRIVE)};
#undef OF_DRIVE
#undef OF_PLANT
    for (int i = 0; i < SIGNALS; ++i) {
        const signal_row *signal = signal_at(static_cast<drive_signal>(i));
        if (signal_text(static_cast<drive_signal>(i))->traced &&
            std::find(columns.begin(), columns.end(), signal) == columns.end()) {
            columns.push_back(signal);
        }
    }
    return columns;
}

const std::vector<const signal_row *> column_signals = signals_of_columns();

} // namespace

const char *column_name(Column column)
{
#define NAME(column, name)            #name,
#define RENAMED(column, member, name) #name,
    static const char *const names[NAMED_COLUMNS] = {TRACE_COLUMNS(NAME, NAME, RENAMED)};
#undef NAME
#undef RENAMED
    return column < NAMED_COLUMNS ? names[column] : column_signals[column]->name;
}

void put_signals(Row &row, const drive_signals &signals)
{
#define OF_DRIVE(column, member, ...) row[column] = static_cast<double>(signals.member);
#define OF_PLANT(column, name)
#define RENAMED(column, member, name) OF_DRIVE(column, member)
    TRACE_COLUMNS(OF_DRIVE, OF_PLANT, RENAMED)
#undef OF_DRIVE
#undef OF_PLANT
#undef RENAMED
    for (std::size_t column = NAMED_COLUMNS; column < COLUMNS; ++column) {
        row[column] = signal_get(&signals, column_signals[column]);
    }
}

void Record::append(const Row &row)
{
    constexpr std::uint64_t prime = 0x100000001b3u;
    constexpr std::uint64_t any_nan = 0x7ff8000000000000u;
    std::uint64_t hash = hash_;
    for (const double value : row) {
        std::uint64_t bits;
        std::memcpy(&bits, &value, sizeof bits);
        hash = (hash ^ (value == value ? bits : any_nan)) * prime;
    }
    hash_ = hash;
    if (started_) {
        pass_on(row);
    } else {
        waiting_.push_back(row);
    }
}

void Record::start_time_here()
{
    time_zero_row_ = waiting_.size();
    pass_on_waiting();
}

void Record::end()
{
    if (!started_) {
        pass_on_waiting();
    }
}

void Record::pass_on(const Row &row)
{
    for (RowReader *const reader : readers_) {
        reader->read(*this, row);
    }
    ++rows_;
}

void Record::pass_on_waiting()
{
    started_ = true;
    for (const Row &row : waiting_) {
        pass_on(row);
    }
    waiting_ = {};
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
