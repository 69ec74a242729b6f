/*
 * The trace of a run as a file: time_s and every column of the record, a row each, written as the
 * rows come.
 *
 * trace.csv: text, a heading and the shortest digits that read back as the same bits.
 * trace.npy: the rows as they are in memory, doubles of 8 bytes, little endian, behind a heading
 *            that says so: NumPy's format, version 1.0 (NEP 1), of a structured array.
 */
#ifndef STEADYSTEP_SCENARIO_TRACE_H
#define STEADYSTEP_SCENARIO_TRACE_H

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "sil/scenario/output.h"
#include "sil/scenario/record.h"

namespace scenario
{

class Trace : public RowReader
{
  public:
    virtual void finish() = 0; /* behind the last row; throws InputError */
};

/* Of "csv", "npy", "both" or "none": those that go to the folder. */
std::vector<std::unique_ptr<Trace>> traces_of(const std::string &kind,
                                              const std::filesystem::path &folder);

class CsvTrace : public Trace
{
  public:
    explicit CsvTrace(const std::filesystem::path &file);

    void read(const Record &record, const Row &row) override;
    void finish() override;

  private:
    /* A number and its digits: most columns hold for many rows what they held before. */
    struct Cell {
        std::uint64_t bits = 0;
        std::array<char, 25> digits = {};
        std::uint8_t length = 0;
    };
    char *put(Cell &cell, double number, char *at);

    FileAside file_;
    Cell time_;
    std::array<Cell, COLUMNS> cells_;
};

class NpyTrace : public Trace
{
  public:
    explicit NpyTrace(const std::filesystem::path &file);

    void read(const Record &record, const Row &row) override;
    void finish() override;

  private:
    FileAside file_;
    std::size_t rows_ = 0;
};

} // namespace scenario

#endif
