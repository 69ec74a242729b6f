#include "sil/scenario/result.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>
#include <utility>

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
             const Record &record)
{
    return static_cast<double>(
        std::count_if(incidents.begin(), incidents.end(), [&](const Incident &incident) {
            return incident.kind == kind && contains(record, window, incident.time_s);
        }));
}

WindowResult evaluate_window(const Record &record, const Window &window,
                             const MetricSettings &settings, const std::vector<Incident> &incidents)
{
    WindowResult result;
    const RowRange rows = rows_of(record, window);
    if (!rows.empty()) {
        result.begin_s = record.time_s(rows.first);
        result.end_s = record.time_s(rows.last - 1);
    }
    result.metrics = evaluate(record, rows, settings);
    for (const Incident &incident : incidents) { /* one too short for the rows that are recorded */
        if (result.metrics.fault == "none" && incident.kind == Incident::Kind::fault &&
            contains(record, window, incident.time_s)) {
            result.metrics.fault = incident.what;
        }
    }
    result.metrics.commands_refused = count(incidents, Incident::Kind::refused, window, record);
    result.metrics.commands_dropped = count(incidents, Incident::Kind::dropped, window, record);
    return result;
}

bool names(const std::vector<std::string> &faults, const std::string &fault)
{
    return std::find(faults.begin(), faults.end(), fault) != faults.end();
}

/* An expectation of exactly this, in a window that it lies in. How many times, is the bound's. */
bool expects(const Expectation &expectation, const Incident &incident, const Record &record)
{
    return expectation.metric == incident.metric() &&
           (!expectation.of_fault() || names(expectation.equals_text, incident.what)) &&
           contains(record, expectation.window, incident.time_s);
}

void judge_incidents(Result &result, const Record &record)
{
    const std::vector<Expectation> &expectations = result.scenario->expectations;
    for (Incident &incident : result.incidents) {
        incident.expected =
            std::any_of(expectations.begin(), expectations.end(),
                        [&](const Expectation &one) { return expects(one, incident, record); });
    }
}

Observation observe(const Expectation &expectation, const Record &record,
                    const MetricSettings &settings, const std::vector<Incident> &incidents)
{
    const Metrics metrics =
        evaluate_window(record, expectation.window, settings, incidents).metrics;
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

/* Rank of the 95th percentile of n sorted values, from 0. */
std::size_t rank_95(std::size_t n)
{
    return (95 * n + 99) / 100 - 1;
}

} // namespace

namespace
{

/* Whether the reference moves more slowly than that for a tenth of a second, all ramps together. */
bool creeps_below(double speed_rad_s, const Record &record)
{
    double time_s = 0;
    for (std::size_t row = record.time_zero_row(); row < record.rows(); ++row) {
        const double speed = std::fabs(record.at(row, OMEGA_REF));
        if (speed > 0 && speed < speed_rad_s) {
            time_s += record.period_s();
        }
    }
    return time_s >= 0.1;
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
               Record &record)
{
    Result result;
    result.scenario = &scenario;
    result.numeric = image.numeric;
    result.seed = seed;

    const double start_s = cpu_seconds();
    Run run{Record(1), 0, 0, 0, 0, 0, "", {}, ""};
    if (scenario.given.image.empty()) {
        run = scenario::run(scenario, image, seed);
    } else {
        ImageRun on_board = run_image(scenario, result.numeric, seed);
        run = std::move(on_board.run);
        result.board = std::move(on_board.board);
    }
    result.cpu_s = cpu_seconds() - start_s;

    record = std::move(run.record);
    result.failure = run.failure;
    result.incidents = std::move(run.incidents);
    result.serial = run.serial;
    if (creeps_below(run.blind_speed_rad_s, record)) {
        result.blind_below_rad_s = run.blind_speed_rad_s;
    }
    result.hold_yield_rad = hold_yield_rad(scenario, record);
    result.trace_hash = record.hash();
    result.drive_hash = run.drive_hash;
    result.simulated_s =
        run.time_zero_s +
        static_cast<double>(record.rows() - record.time_zero_row()) * record.period_s();

    const MetricSettings settings{scenario.motor.params.rotor_teeth, scenario.settling_band_rad,
                                  run.enabling_time_s, run.enabling_motion_max_rad,
                                  run.enabling_displacement_rad};
    const std::vector<Incident> &incidents = result.incidents;
    judge_incidents(result, record);
    result.move = evaluate_window(record, {Window::Kind::move}, settings, incidents);
    result.rest = evaluate_window(record, {Window::Kind::rest}, settings, incidents);
    result.all = evaluate_window(record, {Window::Kind::all}, settings, incidents);
    const auto observed = [&](const Expectation &one) {
        return result.failure.empty() ? observe(one, record, settings, incidents) : Observation{};
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
