#include "sil/scenario/report.h"

#include <algorithm>

#include "sil/scenario/image_run.h"
#include "sil/scenario/output.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

std::string shown(const Expectation &expectation, const Observation &observation)
{
    if (expectation.of_fault()) {
        return observation.text.empty() ? "-" : observation.text;
    }
    return observation.value == observation.value ? format("%.3g", observation.value) : "none";
}

std::string heading(const std::vector<Result> &results)
{
    const Result &first = results.front();
    std::string seeds = results.size() == 1
                            ? format("seed %llu", static_cast<unsigned long long>(first.seed))
                            : format("seeds %llu-%llu", static_cast<unsigned long long>(first.seed),
                                     static_cast<unsigned long long>(results.back().seed));
    double simulated_s = 0, cpu_s = 0;
    for (const Result &result : results) {
        simulated_s += result.simulated_s;
        cpu_s += result.cpu_s;
    }
    std::string text = first.scenario->name + "  " + first.numeric + "  " + seeds +
                       format("  %.4g s simulated in %.2g s", simulated_s, cpu_s);
    if (cpu_s > 0) {
        text += format(" (%.0f x real time)", simulated_s / cpu_s);
    }
    return text + "\n  " + first.scenario->description + "\n";
}

/* A line of the table; without a column for the worst of several runs if `worst` is empty. */
std::string line(const std::string &metric, const std::string &window, const std::string &value,
                 const std::string &worst, const std::string &bound, const std::string &verdict)
{
    std::string text =
        format("  %-32s %-12s %-12s ", metric.c_str(), window.c_str(), value.c_str());
    text += worst.empty() ? "" : format("%-12s ", worst.c_str());
    return text + format("%-15s %s\n", bound.c_str(), verdict.c_str());
}

/* The main figures of one window, of one run. */
std::string figures(const char *name, const WindowResult &window)
{
    if (window.begin_s != window.begin_s) {
        return "";
    }
    const Metrics &m = window.metrics;
    return format("  %-5s %.3g...%.3g s: estimate error max %.2g rms %.2g rad, position error max "
                  "%.2g final %.2g rad, load error rms %.2g Nm, current peak %.2g A\n",
                  name, window.begin_s, window.end_s, m.estimate_error_max_rad,
                  m.estimate_error_rms_rad, m.position_error_max_rad, m.position_error_final_rad,
                  m.load_torque_error_rms_Nm, m.current_peak_A);
}

/* What happened without being expected, of each run; of a single one what was expected, too. */
std::string incidents_of(const Result &result, bool all)
{
    constexpr std::size_t most_lines = 8;
    std::string text;
    std::size_t lines = 0, left_out = 0;
    for (const Incident &incident : result.incidents) {
        if (incident.expected && !all) {
            continue;
        }
        if (lines++ >= most_lines) {
            ++left_out;
            continue;
        }
        text += (incident.expected ? "  expected  " : "  NOT EXPECTED  ") +
                format("seed %llu: ", static_cast<unsigned long long>(result.seed)) +
                incident.text() + "\n";
    }
    return text + (left_out == 0 ? "" : format("  and %zu more\n", left_out));
}

bool all_expected(const Result &result)
{
    return std::all_of(result.incidents.begin(), result.incidents.end(),
                       [](const Incident &incident) { return incident.expected; });
}

} // namespace

Report report(const std::vector<Result> &results)
{
    const Result &first = results.front();
    const Scenario &scenario = *first.scenario;
    const bool many = results.size() > 1;
    Report report;
    report.passed = true;
    report.text = heading(results);
    std::uint64_t seed_to_reproduce = first.seed;

    for (const Result &result : results) {
        if (!result.failure.empty()) {
            report.passed = false;
            report.text +=
                format("  FAILED  seed %llu: %s\n", static_cast<unsigned long long>(result.seed),
                       result.failure.c_str());
            seed_to_reproduce = result.seed;
        }
        if (!all_expected(result)) {
            report.passed = false;
            seed_to_reproduce = result.seed;
        }
        report.text += incidents_of(result, !many);
    }
    if (!scenario.expectations.empty() || !scenario.reports.empty()) {
        report.text += line("expectation", "window", many ? "95 % of runs" : "value",
                            many ? "worst" : "", "bound", "");
    }
    for (std::size_t i = 0; i < scenario.expectations.size(); ++i) {
        const Expectation &expectation = scenario.expectations[i];
        const Judgement judgement = judge(expectation, i, results);
        report.text += line(expectation.metric, expectation.window.name(),
                            shown(expectation, judgement.typical),
                            many ? shown(expectation, judgement.worst) : "", expectation.bound(),
                            judgement.held ? "held" : "NOT HELD");
        if (!judgement.held) {
            report.passed = false;
            seed_to_reproduce = judgement.worst_seed;
        }
    }
    for (std::size_t i = 0; i < scenario.reports.size(); ++i) {
        const Expectation &figure = scenario.reports[i];
        const Judgement judgement = judge(figure, i, results, &Result::reported);
        report.text += line(figure.metric, figure.window.name(), shown(figure, judgement.typical),
                            many ? shown(figure, judgement.worst) : "", "", "reported");
    }
    if (many) {
        report.text +=
            format("  figures of seed %llu:\n", static_cast<unsigned long long>(first.seed));
    }
    report.text += figures("move", first.move) + figures("rest", first.rest);
    if (first.blind_below_rad_s) {
        report.text += format("  blind: +-%.3g A for a %.3g A motor: creep below %.2g rad/s is out "
                              "of reach\n",
                              scenario.plant.sensors.current_range_A,
                              scenario.motor.params.rated_current_A, *first.blind_below_rad_s);
    }
    if (first.board) {
        report.text += interrupt_table(*first.board, first.cpu_s);
    }
    report.text += "  trace " + hexadecimal(first.trace_hash) + "  drive " +
                   hexadecimal(first.drive_hash) + "\n";
    if (!report.passed) {
        report.text +=
            "  reproduce: " + reproduce_command(scenario, first.numeric, seed_to_reproduce) + "\n";
    }
    return report;
}

} // namespace scenario
