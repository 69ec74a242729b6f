#include "sil/scenario/trace.h"

#include <charconv>
#include <cstring>

namespace scenario
{

namespace fs = std::filesystem;

namespace
{

std::string csv_heading()
{
    std::string line = "time_s";
    for (std::size_t column = 0; column < COLUMNS; ++column) {
        line += ',';
        line += column_name(static_cast<Column>(column));
    }
    return line + '\n';
}

/* Of the same length whatever the number of rows, because that is known at the end. */
std::string npy_heading(std::size_t rows)
{
    constexpr std::size_t prefix = 10, alignment = 64, digits = 20;
    std::string fields = "('time_s', '<f8')";
    for (std::size_t column = 0; column < COLUMNS; ++column) {
        fields += std::string(", ('") + column_name(static_cast<Column>(column)) + "', '<f8')";
    }
    const std::string count = std::to_string(rows);
    std::string text = "{'descr': [" + fields + "], 'fortran_order': False, 'shape': (" + count +
                       ",), }" + std::string(digits - count.size(), ' ');
    const std::size_t odd = (prefix + text.size() + 1) % alignment;
    text += std::string(odd == 0 ? 0 : alignment - odd, ' ') + '\n';
    const auto length = static_cast<unsigned>(text.size());
    const char version[] = {'\x93',
                            'N',
                            'U',
                            'M',
                            'P',
                            'Y',
                            1,
                            0,
                            static_cast<char>(length % 256),
                            static_cast<char>(length / 256)};
    static_assert(sizeof version == prefix);
    return std::string(version, sizeof version) + text;
}

} // namespace

std::vector<std::unique_ptr<Trace>> traces_of(const std::string &kind, const fs::path &folder)
{
    std::vector<std::unique_ptr<Trace>> traces;
    if (kind == "csv" || kind == "both") {
        traces.push_back(std::make_unique<CsvTrace>(folder / "trace.csv"));
    }
    if (kind == "npy" || kind == "both") {
        traces.push_back(std::make_unique<NpyTrace>(folder / "trace.npy"));
    }
    return traces;
}

CsvTrace::CsvTrace(const fs::path &file) : file_(file)
{
    const std::string heading = csv_heading();
    file_.write(heading.data(), heading.size());
}

char *CsvTrace::put(Cell &cell, double number, char *at)
{
    std::uint64_t bits;
    std::memcpy(&bits, &number, sizeof bits);
    if (cell.length == 0 || cell.bits != bits) {
        char *const first = cell.digits.data();
        const std::to_chars_result end = std::to_chars(first, first + cell.digits.size(), number);
        cell.bits = bits;
        cell.length = static_cast<std::uint8_t>(end.ptr - first);
    }
    std::memcpy(at, cell.digits.data(), cell.digits.size()); /* of fixed length, so in registers */
    return at + cell.length;
}

void CsvTrace::read(const Record &record, const Row &row)
{
    std::array<char, (COLUMNS + 1) * (sizeof(Cell::digits) + 1)> line;
    char *at = put(time_, record.time_s(record.rows()), line.data());
    for (std::size_t column = 0; column < COLUMNS; ++column) {
        *at++ = ',';
        at = put(cells_[column], row[column], at);
    }
    *at++ = '\n';
    file_.write(line.data(), static_cast<std::size_t>(at - line.data()));
}

void CsvTrace::finish()
{
    file_.finish();
}

NpyTrace::NpyTrace(const fs::path &file) : file_(file)
{
    const std::string heading = npy_heading(0);
    file_.write(heading.data(), heading.size());
}

void NpyTrace::read(const Record &record, const Row &row)
{
    const double time_s = record.time_s(record.rows());
    file_.write(&time_s, sizeof time_s);
    file_.write(row.data(), sizeof row);
    ++rows_;
}

void NpyTrace::finish()
{
    const std::string heading = npy_heading(rows_);
    file_.rewrite_begin(heading.data(), heading.size());
    file_.finish();
}

} // namespace scenario
