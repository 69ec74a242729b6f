/* Standard output, and the files that --out receives. Each is written aside and renamed, so that
   none is ever half there. */
#ifndef STEADYSTEP_SCENARIO_OUTPUT_H
#define STEADYSTEP_SCENARIO_OUTPUT_H

#include <filesystem>
#include <string>
#include <vector>

#include "sil/scenario/record.h"
#include "sil/scenario/result.h"

namespace scenario
{

/* To standard output, at once; throws InputError if it does not take all of it. */
void print(const std::string &text);

/* The folder exists and takes files afterwards; throws InputError. */
void prepare_folder(const std::filesystem::path &folder);

/* Throws InputError if the file cannot be written. */
void write_file(const std::filesystem::path &file, const std::string &content);

/* summary.json: what ran, all metrics per window, expectations, hashes. A metric without a value
   is null. */
std::string summary_json(const Result &result);

/* The same of several runs, an array on one line. */
std::string summaries_json(const std::vector<Result> &results);

/* trace.csv: time_s and every column of the record, shortest digits that read back the same. */
std::string trace_csv(const Record &record);

/* An argument as a shell takes it. */
std::string quoted(const std::string &argument);

/* One line for a shell that repeats this run. */
std::string reproduce_command(const Scenario &scenario, const std::string &numeric,
                              std::uint64_t seed);

} // namespace scenario

#endif
