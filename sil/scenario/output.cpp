#include "sil/scenario/output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "sil/scenario/text.h"

namespace scenario
{

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace
{

Json window_json(const WindowResult &window)
{
    Json json;
    json["begin_s"] = window.begin_s; /* NaN becomes null, here and below */
    json["end_s"] = window.end_s;
    for (const MetricField &field : metric_fields()) {
        json[field.name] = window.metrics.*field.value;
    }
    json["fault"] = window.metrics.fault;
    return json;
}

Json expectation_json(const Expectation &expectation, const Observation &observation)
{
    Json json;
    json["metric"] = expectation.metric;
    json["window"] = expectation.window.name();
    if (expectation.min) {
        json["min"] = *expectation.min;
    }
    if (expectation.max) {
        json["max"] = *expectation.max;
    }
    if (expectation.equals) {
        json["equals"] = *expectation.equals;
    }
    if (expectation.of_fault()) {
        json["equals"] = expectation.equals_text.size() == 1 ? Json(expectation.equals_text.front())
                                                             : Json(expectation.equals_text);
        json["value"] = observation.text;
    } else {
        json["value"] = observation.value;
    }
    json["passed"] = observation.held;
    return json;
}

} // namespace

void print(const std::string &text)
{
    errno = 0;
    const bool all = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
    if (std::fflush(stdout) != 0 || !all) {
        throw InputError("standard output: cannot be written: " +
                         std::string(std::strerror(errno)));
    }
}

void prepare_folder(const fs::path &folder)
{
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) {
        throw InputError("--out " + folder.string() + ": cannot be made: " + error.message());
    }
    if (access(folder.c_str(), W_OK | X_OK) != 0) {
        throw InputError("--out " + folder.string() +
                         ": cannot be written: " + std::strerror(errno));
    }
}

FileAside::FileAside(const fs::path &file) : file_(file), aside_(file.string() + ".part")
{
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    stream_.open(aside_, std::ios::binary);
}

FileAside::~FileAside()
{
    if (!finished_) {
        stream_.close();
        std::error_code error;
        fs::remove(aside_, error);
    }
}

void FileAside::write(const void *bytes, std::size_t count)
{
    stream_.write(static_cast<const char *>(bytes), static_cast<std::streamsize>(count));
}

void FileAside::rewrite_begin(const void *bytes, std::size_t count)
{
    stream_.seekp(0);
    write(bytes, count);
}

void FileAside::finish()
{
    stream_.close();
    std::error_code error;
    if (stream_) {
        fs::rename(aside_, file_, error);
    }
    if (!stream_ || error) {
        throw InputError(file_.string() + ": cannot be written");
    }
    finished_ = true;
}

void write_file(const fs::path &file, const std::string &content)
{
    FileAside aside(file);
    aside.write(content.data(), content.size());
    aside.finish();
}

namespace
{

Json figures_json(const virtual_board::CycleFigures &figures)
{
    Json json;
    const auto column = [&](const char *name, const virtual_board::Figures &cycles) {
        json[name]["mean"] = cycles.mean;
        json[name]["p999"] = cycles.p999;
        json[name]["worst"] = cycles.worst;
    };
    column("nominal", figures.nominal);
    column("worst_ccm", figures.worst);
    column("worst_flash", figures.flash);
    return json;
}

/* The control interrupt on the virtual board; all cycles are the core's. */
Json interrupt_json(const Result &result)
{
    const virtual_board::InterruptAccount::Summary &interrupt = result.board->interrupt;
    Json json;
    json["image"] = result.scenario->given.image;
    json["interrupts"] = interrupt.interrupts;
    json["interrupts_in_control"] = interrupt.in_control;
    json["budget_cycles"] = result.board->budget_cycles;
    json["total_cycles"] = figures_json(interrupt.total);
    for (std::size_t i = 0; i < interrupt.stages.size(); ++i) {
        json["stage_cycles"][interrupt.stage_names[i]] = figures_json(interrupt.stages[i]);
    }
    json["start_latency_cycles"]["least"] = interrupt.latency.least;
    json["start_latency_cycles"]["mean"] = interrupt.latency.mean;
    json["start_latency_cycles"]["worst"] = interrupt.latency.worst;
    json["start_jitter_cycles"] = interrupt.latency.worst - interrupt.latency.least;
    const auto us = [](double cycles) { return cycles * 1e6 / virtual_board::core_Hz; };
    json["start_latency_us"]["least"] = us(static_cast<double>(interrupt.latency.least));
    json["start_latency_us"]["mean"] = us(interrupt.latency.mean);
    json["start_latency_us"]["worst"] = us(static_cast<double>(interrupt.latency.worst));
    json["preemptions"] = interrupt.preemptions;
    json["preempting_cycles"] = interrupt.preempting_cycles;
    json["instructions_outside_ccm"] = interrupt.outside_fast_code;
    json["serial_line"]["bytes_in"] = result.board->bytes_received;
    json["serial_line"]["bytes_out"] = result.board->bytes_sent;
    json["flash"]["pages_erased"] = result.board->flash_erases;
    json["flash"]["double_words_programmed"] = result.board->flash_programs;
    json["stack_used_bytes"] =
        result.board->stack_used_bytes ? Json(*result.board->stack_used_bytes) : Json();
    json["resets"] = result.board->resets;
    json["times_real_time"] =
        result.cpu_s > 0 ? Json(result.board->simulated_s / result.cpu_s) : Json();
    return json;
}

void put_incidents(Json &json, const std::vector<Incident> &incidents)
{
    for (const char *const list : {"faults", "commands_refused", "commands_dropped"}) {
        json[list] = Json::array();
    }
    for (const Incident &incident : incidents) {
        Json one;
        one["time_s"] = incident.time_s;
        const bool fault = incident.kind == Incident::Kind::fault;
        one[fault ? "fault" : "command"] = incident.what;
        if (incident.kind == Incident::Kind::refused) {
            one["reason"] = incident.reason;
        }
        one["expected"] = incident.expected;
        json[fault ? "faults" : incident.metric()].push_back(one);
    }
}

Json summary(const Result &result)
{
    const Scenario &scenario = *result.scenario;
    Json json;
    json["scenario"] = scenario.name;
    json["description"] = scenario.description;
    json["motor"] = scenario.motor.id;
    json["numeric"] = result.numeric;
    json["seed"] = result.seed;
    json["parameters"] = scenario.parameters.empty() ? Json() : Json(scenario.parameters);
    json["settings"] =
        scenario.given.settings_file.empty() ? Json() : Json(scenario.given.settings_file);
    json["law"] = drive_law_name(scenario.drive.law);
    json["set"] = scenario.given.settings;
    json["version"] = STEADYSTEP_VERSION;
    json["reproduce"] = reproduce_command(scenario, result.numeric, result.seed);
    json["passed"] = result.passed();
    const std::string failure = result.not_as_described();
    json["failure"] = failure.empty() ? Json() : Json(failure);
    put_incidents(json, result.incidents);
    json["simulated_s"] = result.simulated_s;
    json["cpu_s"] = result.cpu_s;
    json["blind_below_rad_s"] = result.blind_below_rad_s ? Json(*result.blind_below_rad_s) : Json();
    json["hold_yield_rad"] = result.hold_yield_rad ? Json(*result.hold_yield_rad) : Json();
    json["hold_torque_Nm"] = result.hold_torque_Nm ? Json(*result.hold_torque_Nm) : Json();
    json["hold_heat_W"] = result.hold_heat_W ? Json(*result.hold_heat_W) : Json();
    json["trace_hash"] = hexadecimal(result.trace_hash);
    json["drive_hash"] = hexadecimal(result.drive_hash);
    json["metrics"]["move"] = window_json(result.move);
    json["metrics"]["rest"] = window_json(result.rest);
    json["metrics"]["all"] = window_json(result.all);
    json["expectations"] = Json::array();
    for (std::size_t i = 0; i < scenario.expectations.size(); ++i) {
        json["expectations"].push_back(
            expectation_json(scenario.expectations[i], result.observations[i]));
    }
    if (result.board) {
        json["interrupt"] = interrupt_json(result);
    }
    json["reports"] = Json::array();
    for (std::size_t i = 0; i < scenario.reports.size(); ++i) {
        Json report;
        report["metric"] = scenario.reports[i].metric;
        report["window"] = scenario.reports[i].window.name();
        report["value"] = result.reported[i].value;
        json["reports"].push_back(report);
    }
    return json;
}

} // namespace

std::string summary_json(const Result &result)
{
    return summary(result).dump(2) + "\n";
}

std::string summaries_json(const std::vector<Result> &results)
{
    Json json = Json::array();
    for (const Result &result : results) {
        json.push_back(summary(result));
    }
    return json.dump() + "\n";
}

std::string quoted(const std::string &argument)
{
    const std::string plain =
        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_=./:+";
    if (argument.find_first_not_of(plain) == std::string::npos) {
        return argument;
    }
    std::string text = "'";
    for (const char letter : argument) {
        text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
    }
    return text + "'";
}

std::string reproduce_command(const Scenario &scenario, const std::string &numeric,
                              std::uint64_t seed)
{
    std::string command = "steadystep-sil run " + quoted(scenario.asked) + " --numeric " + numeric +
                          " --seed " + std::to_string(seed);
    if (!scenario.given.parameters.empty()) {
        command += " --parameters " + quoted(scenario.given.parameters);
    }
    if (!scenario.given.settings_file.empty()) {
        command += " --settings " + quoted(scenario.given.settings_file);
    }
    if (!scenario.given.image.empty()) {
        command += " --image " + quoted(scenario.given.image);
    } else if (scenario.given.typed) {
        command += " --typed";
    }
    for (const std::string &setting : scenario.given.settings) {
        command += " --set " + quoted(setting);
    }
    return command;
}

} // namespace scenario
