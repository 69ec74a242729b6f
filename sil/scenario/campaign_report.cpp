#include "sil/scenario/campaign_report.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <nlohmann/json.hpp>

#include "sil/scenario/output.h"
#include "sil/scenario/text.h"

namespace scenario
{

using Json = nlohmann::ordered_json;

namespace
{

constexpr std::size_t most_commands = 20; /* of runs that did not hold */

struct Distribution {
    std::size_t count = 0; /* runs that have the figure */
    double sum = 0, median = Metrics::none, percentile_95 = Metrics::none, worst = Metrics::none;
    std::uint64_t worst_seed = 0;
};

/* Of one figure, largest worst. */
Distribution distribution_of(const std::vector<CampaignRun> &runs, std::size_t figure)
{
    Distribution found;
    std::vector<double> values;
    for (const CampaignRun &run : runs) {
        const double value = run.outcome.figures[figure];
        if (value != value) {
            continue;
        }
        values.push_back(value);
        found.sum += value;
        if (!(value <= found.worst)) {
            found.worst = value;
            found.worst_seed = run.seed;
        }
    }
    found.count = values.size();
    if (!values.empty()) {
        found.percentile_95 = percentile_95(values);
        std::sort(values.begin(), values.end());
        found.median = values[(values.size() - 1) / 2];
    }
    return found;
}

/* Seeds by verdict, "held" first. */
std::vector<std::pair<std::string, std::vector<std::uint64_t>>>
by_verdict(const std::vector<CampaignRun> &runs)
{
    std::map<std::string, std::vector<std::uint64_t>> others;
    std::vector<std::uint64_t> held;
    for (const CampaignRun &run : runs) {
        (run.outcome.held() ? held : others[run.outcome.verdict]).push_back(run.seed);
    }
    std::vector<std::pair<std::string, std::vector<std::uint64_t>>> all{{"held", held}};
    all.insert(all.end(), others.begin(), others.end());
    return all;
}

/* Below this the true rate lies with 95 % confidence if none of n runs failed. */
double rate_excluded(std::size_t n)
{
    return 1 - std::pow(0.05, 1 / static_cast<double>(n));
}

std::string seeds_text(const CampaignOrder &order)
{
    const std::uint64_t last = order.first_seed + order.seeds - 1;
    return order.seeds == 1
               ? "seed " + std::to_string(last)
               : "seeds " + std::to_string(order.first_seed) + "-" + std::to_string(last);
}

std::string verdict_table(const std::vector<CampaignRun> &runs)
{
    std::string text = format("  %-36s %8s\n", "verdict", "runs");
    for (const auto &[verdict, seeds] : by_verdict(runs)) {
        text += format("  %-36s %8zu", verdict.c_str(), seeds.size());
        if (verdict == "held" && seeds.size() == runs.size()) {
            text += format("   of a single run, another verdict below %.2g %% (95 %% confidence)",
                           100 * rate_excluded(runs.size()));
        }
        text += "\n";
    }
    return text;
}

std::string figure_table(const CampaignOrder &order, const std::vector<CampaignRun> &runs)
{
    std::string text = format("  %-36s %9s %9s %9s %9s %6s\n", "figure", "sum", "median", "95 % of",
                              "worst", "seed");
    for (std::size_t i = 0; i < order.kind->figures.size(); ++i) {
        const CampaignFigure &figure = order.kind->figures[i];
        const Distribution found = distribution_of(runs, i);
        if (found.count == 0) {
            text += format("  %-36s %9s\n", figure.name, "none");
            continue;
        }
        text += format("  %-36s %9s %9.3g %9.3g %9.3g %6llu\n", figure.name,
                       figure.counted ? format("%.6g", found.sum).c_str() : "", found.median,
                       found.percentile_95, found.worst,
                       static_cast<unsigned long long>(found.worst_seed));
    }
    return text;
}

/* On the command line of the campaign what is laid over its scenarios. */
std::string given_text(const CampaignOrder &order)
{
    std::string text;
    if (!order.given.parameters.empty()) {
        text += " --parameters " + quoted(order.given.parameters);
    }
    for (const std::string &setting : order.given.settings) {
        text += " --set " + quoted(setting);
    }
    return text;
}

/* The words of the first refusal of each quantity. */
std::string refusal_lines(const CampaignOrder &order, const std::vector<CampaignRun> &runs)
{
    std::map<std::string, const CampaignRun *> first;
    for (const CampaignRun &run : runs) {
        if (run.outcome.refused()) {
            first.emplace(run.outcome.verdict, &run);
        }
    }
    std::string text;
    for (const auto &[verdict, run] : first) {
        text += "  REFUSED  " + run->failure + "; " + reproduce_command(order, run->seed) + "\n";
    }
    return text;
}

} // namespace

std::string reproduce_command(const CampaignOrder &order, std::uint64_t seed)
{
    std::string command = std::string("steadystep-sil campaign ") + order.kind->name + " --seed " +
                          std::to_string(seed) + " --numeric " + order.numeric;
    if (order.duration_s != order.kind->duration_s) {
        command += " --duration " + shortest(order.duration_s);
    }
    if (order.motor.spread != CampaignMotor().spread) {
        command += " --stretch";
    }
    return command + given_text(order);
}

std::string not_held_line(const CampaignOrder &order, const CampaignRun &run)
{
    return "steadystep-sil: seed " + std::to_string(run.seed) + ": " + run.outcome.verdict +
           (run.failure.empty() ? "" : ": " + run.failure) + "; " +
           reproduce_command(order, run.seed) + "\n";
}

std::string campaign_report(const CampaignOrder &order, const std::vector<CampaignRun> &runs)
{
    double simulated_s = 0;
    std::size_t held = 0, refused = 0, within_limit = 0;
    for (const CampaignRun &run : runs) {
        simulated_s += run.simulated_s;
        held += run.outcome.held() ? 1 : 0;
        refused += run.outcome.refused() ? 1 : 0;
        within_limit += run.outcome.within_limit() ? 1 : 0;
    }
    std::string text = format("campaign %s  %s  %s  ", order.kind->name, order.numeric.c_str(),
                              seeds_text(order).c_str()) +
                       (order.duration_s > 0 ? format("%.4g s each, ", order.duration_s) : "") +
                       format("%.6g s simulated\n", simulated_s);
    text += std::string("  ") + order.kind->description + "\n";
    text += verdict_table(runs) + figure_table(order, runs);
    std::size_t shown = 0;
    for (const CampaignRun &run : runs) {
        if (!run.outcome.accounted_for() && shown++ < most_commands) {
            text += "  NOT HELD  " + run.outcome.verdict + ": " +
                    reproduce_command(order, run.seed) + "\n";
        }
    }
    if (shown > most_commands) {
        text += format("  and %zu more\n", shown - most_commands);
    }
    text += refusal_lines(order, runs);
    text += format("%zu of %zu runs hold", held, runs.size());
    if (within_limit > 0) {
        text += format(", %zu keep to their computed limit", within_limit);
    }
    return text + (refused > 0 ? format(", %zu are refused\n", refused) : "\n");
}

std::string campaign_json(const CampaignOrder &order, const std::vector<CampaignRun> &runs)
{
    Json json;
    json["campaign"] = order.kind->name;
    json["description"] = order.kind->description;
    json["numeric"] = order.numeric;
    json["version"] = STEADYSTEP_VERSION;
    json["duration_s"] = order.duration_s;
    json["first_seed"] = order.first_seed;
    json["seeds"] = order.seeds;
    json["set"] = order.given.settings;
    for (const auto &[verdict, seeds] : by_verdict(runs)) {
        json["verdicts"][verdict] = seeds.size();
    }
    for (std::size_t i = 0; i < order.kind->figures.size(); ++i) {
        const Distribution found = distribution_of(runs, i);
        Json figure;
        figure["runs"] = found.count;
        figure["sum"] = found.sum;
        figure["median"] = found.median;
        figure["percentile_95"] = found.percentile_95;
        figure["worst"] = found.worst;
        figure["worst_seed"] = found.worst_seed;
        figure["reproduce"] = reproduce_command(order, found.worst_seed);
        json["figures"][order.kind->figures[i].name] = figure;
    }
    json["runs"] = Json::array();
    for (const CampaignRun &run : runs) {
        Json one;
        one["seed"] = run.seed;
        one["verdict"] = run.outcome.verdict;
        for (std::size_t i = 0; i < order.kind->figures.size(); ++i) {
            one[order.kind->figures[i].name] = run.outcome.figures[i];
        }
        one["failure"] = run.failure.empty() ? Json() : Json(run.failure);
        one["trace_hash"] = hexadecimal(run.trace_hash);
        one["drive_hash"] = hexadecimal(run.drive_hash);
        one["reproduce"] = reproduce_command(order, run.seed);
        json["runs"].push_back(one);
    }
    return json.dump(1) + "\n";
}

} // namespace scenario
