#include "sil/scenario/result.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <utility>

#include "sil/scenario/evaluation.h"
#include "sil/scenario/hold_yield.h"
#include "sil/scenario/image_run.h"

namespace scenario
{

namespace
{

/* Of this thread; reported beside the results, never part of them. */
double cpu_seconds()
{
    std::timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double value_of(const Metrics &metrics, const std::string &name)
{
    for (const MetricField &field : metric_fields()) {
        if (name == field.name) {
            return metrics.*field.value;
        }
    }
    return Metrics::none;
}

/* Every comparison is false for a NaN. */
bool holds(const Expectation &expectation, double value)
{
    if (!expectation.bounded()) {
        return true;
    }
    return value == value && (!expectation.min || value >= *expectation.min) &&
           (!expectation.max || value <= *expectation.max) &&
           (!expectation.equals || value == *expectation.equals);
}

double count(const std::vector<Incident> &incidents, Incident::Kind kind, const Window &window,
             const Evaluation &evaluation)
{
    return static_cast<double>(
        std::count_if(incidents.begin(), incidents.end(), [&](const Incident &incident) {
            return incident.kind == kind && evaluation.contains(window, incident.time_s);
        }));
}

/* What has come of a run before it is judged. */
struct Seen {
    const Record &record;
    const Evaluation &evaluation;
    const Run &run;
    const std::vector<Incident> &incidents;
};

WindowResult evaluate_window(const Seen &seen, const Window &window)
{
    WindowResult result;
    const RowRange rows = seen.evaluation.rows_of(window);
    Metrics &metrics = result.metrics;
    metrics = seen.evaluation.metrics_of(window);
    if (!rows.empty()) {
        result.begin_s = seen.record.time_s(rows.first);
        result.end_s = seen.record.time_s(rows.last - 1);
        metrics.enabling_time_s = seen.run.enabling_time_s;
        metrics.enabling_motion_max_rad = seen.run.enabling_motion_max_rad;
        metrics.enabling_displacement_rad = seen.run.enabling_displacement_rad;
    }
    for (const Incident &incident : seen.incidents) { /* one too short for the rows recorded */
        if (metrics.fault == "none" && incident.kind == Incident::Kind::fault &&
            seen.evaluation.contains(window, incident.time_s)) {
            metrics.fault = incident.what;
        }
    }
    metrics.commands_refused =
        count(seen.incidents, Incident::Kind::refused, window, seen.evaluation);
    metrics.commands_dropped =
        count(seen.incidents, Incident::Kind::dropped, window, seen.evaluation);
    return result;
}

bool names(const std::vector<std::string> &faults, const std::string &fault)
{
    return std::find(faults.begin(), faults.end(), fault) != faults.end();
}

/* An expectation of exactly this, in a window that it lies in. How many times, is the bound's. */
bool expects(const Expectation &expectation, const Incident &incident, const Evaluation &evaluation)
{
    return expectation.metric == incident.metric() &&
           (!expectation.of_fault() || names(expectation.equals_text, incident.what)) &&
           evaluation.contains(expectation.window, incident.time_s);
}

void judge_incidents(Result &result, const Evaluation &evaluation)
{
    const std::vector<Expectation> &expectations = result.scenario->expectations;
    for (Incident &incident : result.incidents) {
        incident.expected =
            std::any_of(expectations.begin(), expectations.end(),
                        [&](const Expectation &one) { return expects(one, incident, evaluation); });
    }
}

Observation observe(const Expectation &expectation, const Seen &seen)
{
    const Metrics metrics = evaluate_window(seen, expectation.window).metrics;
    Observation observation;
    if (expectation.of_fault()) {
        observation.text = metrics.fault;
        observation.held = names(expectation.equals_text, metrics.fault);
    } else {
        observation.value = value_of(metrics, expectation.metric);
        observation.held = holds(expectation, observation.value);
    }
    return observation;
}

std::vector<Window> windows_of(const Scenario &scenario)
{
    std::vector<Window> windows;
    for (const std::vector<Expectation> *list : {&scenario.expectations, &scenario.reports}) {
        for (const Expectation &expectation : *list) {
            windows.push_back(expectation.window);
        }
    }
    return windows;
}

/* Rank of the 95th percentile of n sorted values, from 0. */
std::size_t rank_95(std::size_t n)
{
    return (95 * n + 99) / 100 - 1;
}

} // namespace

bool Result::passed() const
{
    return failure.empty() &&
           std::all_of(observations.begin(), observations.end(),
                       [](const Observation &o) { return o.held; }) &&
           std::all_of(incidents.begin(), incidents.end(),
                       [](const Incident &i) { return i.expected; });
}

std::string Result::not_as_described() const
{
    if (!failure.empty()) {
        return failure;
    }
    for (const Incident &incident : incidents) {
        if (!incident.expected && incident.kind != Incident::Kind::fault) {
            return incident.text();
        }
    }
    return "";
}

const Incident *Result::unexpected_fault() const
{
    for (const Incident &incident : incidents) {
        if (!incident.expected && incident.kind == Incident::Kind::fault) {
            return &incident;
        }
    }
    return nullptr;
}

Result execute(const Scenario &scenario, const firmware_image &image, std::uint64_t seed,
               const std::vector<RowReader *> &readers)
{
    Result result;
    result.scenario = &scenario;
    result.numeric = image.numeric;
    result.seed = seed;

    Record record(row_period_s(scenario));
    const MetricSettings settings{scenario.motor.params.rotor_teeth, scenario.settling_band_rad};
    const Evaluation evaluation(record, settings, windows_of(scenario));
    HoldYield hold_yield(scenario);
    record.add_reader(hold_yield);
    for (RowReader *const reader : readers) {
        record.add_reader(*reader);
    }

    const double start_s = cpu_seconds();
    Run run;
    if (scenario.given.image.empty()) {
        run = scenario::run(scenario, image, seed, record);
    } else {
        ImageRun on_board = run_image(scenario, result.numeric, seed, record);
        run = std::move(on_board.run);
        result.board = std::move(on_board.board);
    }
    result.cpu_s = cpu_seconds() - start_s;

    result.failure = run.failure;
    result.incidents = std::move(run.incidents);
    result.serial = run.serial;
    result.blind_below_rad_s = run.blind_below_rad_s;
    result.hold_yield_rad = hold_yield.yield_rad();
    if (hold_yield.bearing()) {
        result.hold_torque_Nm = hold_yield.bearing()->torque_Nm;
        result.hold_heat_W = hold_yield.bearing()->heat_W;
    }
    result.trace_hash = record.hash();
    result.drive_hash = run.drive_hash;
    result.simulated_s =
        run.time_zero_s +
        static_cast<double>(record.rows() - record.time_zero_row()) * record.period_s();

    judge_incidents(result, evaluation);
    const Seen seen = {record, evaluation, run, result.incidents};
    result.move = evaluate_window(seen, {Window::Kind::move});
    result.rest = evaluate_window(seen, {Window::Kind::rest});
    result.all = evaluate_window(seen, {Window::Kind::all});
    const auto observed = [&](const Expectation &one) {
        return result.failure.empty() ? observe(one, seen) : Observation{};
    };
    for (const Expectation &expectation : scenario.expectations) {
        result.observations.push_back(observed(expectation));
    }
    for (const Expectation &report : scenario.reports) {
        result.reported.push_back(observed(report));
    }
    return result;
}

Judgement judge(const Expectation &expectation, std::size_t index,
                const std::vector<Result> &results, Observations where)
{
    /* Best run first. */
    std::vector<std::size_t> order(results.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const bool largest_is_best = expectation.min && !expectation.max;
    const auto better = [&](std::size_t a, std::size_t b) {
        const Observation &first = (results[a].*where)[index];
        const Observation &second = (results[b].*where)[index];
        if (first.held != second.held) {
            return first.held;
        }
        if (first.value != first.value || second.value != second.value) {
            return first.value == first.value && second.value != second.value;
        }
        return largest_is_best ? first.value > second.value : first.value < second.value;
    };
    std::stable_sort(order.begin(), order.end(), better);

    Judgement judgement;
    const std::size_t typical = order[rank_95(order.size())];
    judgement.typical = (results[typical].*where)[index];
    judgement.worst = (results[order.back()].*where)[index];
    judgement.worst_seed = results[order.back()].seed;
    judgement.held = judgement.typical.held;
    return judgement;
}

double percentile_95(std::vector<double> values)
{
    std::stable_sort(values.begin(), values.end(),
                     [](double a, double b) { return a == a && (b != b || a < b); });
    return values[rank_95(values.size())];
}

} // namespace scenario
