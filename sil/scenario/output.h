/* Standard output, and what --out receives besides traces (trace.h). Every file is written aside
   and renamed, so that none is ever half there. */
#ifndef STEADYSTEP_SCENARIO_OUTPUT_H
#define STEADYSTEP_SCENARIO_OUTPUT_H

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "sil/scenario/result.h"

namespace scenario
{

/* To standard output, at once; throws InputError if it does not take all of it. */
void print(const std::string &text);

/* The folder exists and takes files afterwards; throws InputError. */
void prepare_folder(const std::filesystem::path &folder);

/* A file that is written aside, piece by piece, and stands under its name once it is whole; if it
   never is, nothing stays. */
class FileAside
{
  public:
    explicit FileAside(const std::filesystem::path &file);
    ~FileAside();
    FileAside(const FileAside &) = delete;
    FileAside &operator=(const FileAside &) = delete;

    void write(const void *bytes, std::size_t count);
    /* Once more from the file's beginning, what is longer than that stays behind it. */
    void rewrite_begin(const void *bytes, std::size_t count);
    void finish(); /* throws InputError if all of it could not be written */

  private:
    std::filesystem::path file_, aside_;
    std::ofstream stream_;
    bool finished_ = false;
};

/* Throws InputError if the file cannot be written. */
void write_file(const std::filesystem::path &file, const std::string &content);

/* summary.json: what ran, all metrics per window, expectations, hashes. A metric without a value
   is null. */
std::string summary_json(const Result &result);

/* The same of several runs, an array on one line. */
std::string summaries_json(const std::vector<Result> &results);

/* An argument as a shell takes it. */
std::string quoted(const std::string &argument);

/* One line for a shell that repeats this run. */
std::string reproduce_command(const Scenario &scenario, const std::string &numeric,
                              std::uint64_t seed);

} // namespace scenario

#endif
