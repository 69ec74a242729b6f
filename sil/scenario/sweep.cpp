#include "sil/scenario/sweep.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "sil/scenario/table_reader.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace
{

std::vector<double> read_scales(TableReader &reader)
{
    reader.require("scales");
    std::vector<double> scales;
    for (const Value &item : reader.array("scales")->items) {
        const bool number = item.kind == Value::Kind::number || item.kind == Value::Kind::integer;
        if (!number || !(item.number >= 0.01 && item.number <= 100)) {
            reader.fail("scales", "expected numbers in 0.01...100");
        }
        scales.push_back(item.number);
    }
    if (scales.empty()) {
        reader.fail("scales", "expected at least one number");
    }
    return scales;
}

void read_row(const Catalogue &catalogue, const Value &table, const std::string &path, Sweep &sweep)
{
    TableReader reader(table, path);
    SweepCase row;
    std::string scenario;
    for (const char *key : {"figure", "parameter", "scenario", "paper"}) {
        reader.require(key);
    }
    std::vector<std::string> parameters;
    for (const PlantScaleField &field : plant_scale_fields()) {
        parameters.push_back(field.key);
    }
    std::size_t parameter = 0;
    double bound_within = 1000;
    reader.text("figure", row.figure);
    reader.choice("parameter", parameter, parameters);
    reader.text("scenario", scenario);
    reader.text("paper", row.paper);
    const std::vector<double> scales = read_scales(reader);
    reader.number("bound_max_rad", row.max_rad, 0, 1000);
    reader.number("bound_rms_rad", row.rms_rad, 0, 1000);
    reader.number("bound_rest_rad", row.rest_rad, 0, 1000);
    reader.number("bound_within", bound_within, 0, 1000);
    reader.finish();

    row.parameter = parameters[parameter];
    const std::string where = table.find("scenario")->location.text() + ": " + path + ".scenario";
    for (const double scale : scales) {
        SweepCase one = row;
        one.scale = scale;
        const CommandLine given{"", {"plant." + row.parameter + "=" + shortest(scale)}};
        one.scenario = read_scenario(catalogue, scenario, given, where);
        if (std::fabs(scale - 1) > bound_within * (1 + 1e-9)) {
            one.max_rad = one.rms_rad = one.rest_rad = Metrics::none;
        }
        sweep.cases.push_back(one);
    }
}

double percentile(const std::vector<Result> &results, const WindowResult Result::*window,
                  double Metrics::*metric)
{
    std::vector<double> values;
    for (const Result &result : results) {
        const bool ran = result.not_as_described().empty();
        values.push_back(ran ? (result.*window).metrics.*metric : Metrics::none);
    }
    return percentile_95(values);
}

/* Of the report with this index. */
double reported_percentile(const std::vector<Result> &results, std::size_t index)
{
    std::vector<double> values;
    for (const Result &result : results) {
        values.push_back(index < result.reported.size() ? result.reported[index].value
                                                        : Metrics::none);
    }
    return percentile_95(values);
}

std::string unexpected(const std::vector<Result> &results)
{
    for (const Result &result : results) {
        const Incident *fault = result.unexpected_fault();
        const std::string what = fault != nullptr ? fault->text() : result.not_as_described();
        if (!what.empty()) {
            return what + format(" (seed %llu)", static_cast<unsigned long long>(result.seed));
        }
    }
    return "";
}

bool is_bound(double bound)
{
    return bound == bound;
}

std::string bounds(const SweepCase &one)
{
    std::string text;
    for (const double bound : {one.max_rad, one.rms_rad, one.rest_rad}) {
        text += (text.empty() ? "" : " / ") + (is_bound(bound) ? format("%.2g", bound) : "-");
    }
    return text;
}

/* What the first two figures are of. */
void read_error(TableReader &reader, Sweep &sweep)
{
    const std::vector<std::string> errors{"estimate", "position"};
    std::size_t error = 0;
    reader.choice("error", error, errors);
    sweep.error = errors[error];
    sweep.window.kind = Window::Kind::move;
    if (reader.number("begin_s", sweep.window.begin_s, 0, 600)) {
        reader.require("end_s");
        reader.number("end_s", sweep.window.end_s, sweep.window.begin_s, 600);
        sweep.window.kind = Window::Kind::times;
    }
}

} // namespace

Sweep read_sweep(const Catalogue &catalogue, const fs::path &file)
{
    Value document = read_toml(file);
    document.location = {file.string(), 0};
    TableReader reader(document, "");
    Sweep sweep;
    sweep.name = file.stem().string();
    reader.require("description");
    reader.text("description", sweep.description);
    read_error(reader, sweep);
    reader.require("row");
    const Value *rows = reader.array("row");
    for (std::size_t i = 0; i < rows->items.size(); ++i) {
        read_row(catalogue, rows->items[i], "row[" + std::to_string(i + 1) + "]", sweep);
    }
    reader.finish();
    for (SweepCase &one : sweep.cases) {
        for (const char *const figure : {"max", "rms"}) {
            Expectation report;
            report.metric = sweep.error + "_error_" + figure + "_rad";
            report.window = sweep.window;
            one.scenario.reports.push_back(report);
        }
    }
    return sweep;
}

SweepFigures figures_of(const SweepCase &one, const std::vector<Result> &results)
{
    const std::size_t max = one.scenario.reports.size() - 2; /* as read_sweep appended them */
    SweepFigures figures{};
    figures.max_rad = reported_percentile(results, max);
    figures.rms_rad = reported_percentile(results, max + 1);
    figures.rest_rad = percentile(results, &Result::rest, &Metrics::position_error_final_rad);
    figures.slip_full_steps = percentile(results, &Result::all, &Metrics::slip_full_steps);
    figures.bounded = is_bound(one.max_rad) || is_bound(one.rms_rad) || is_bound(one.rest_rad);
    const auto holds = [](double value, double bound) {
        return !is_bound(bound) || value <= bound;
    };
    figures.unexpected = unexpected(results);
    figures.held = figures.unexpected.empty() && holds(figures.max_rad, one.max_rad) &&
                   holds(figures.rms_rad, one.rms_rad) && holds(figures.rest_rad, one.rest_rad);
    return figures;
}

std::string sweep_heading(const Sweep &sweep)
{
    const std::string error = sweep.error.substr(0, 3);
    return format("%-7s %-24s %6s  %-32s %9s %9s %9s  %-22s %s\n", "figure", "plant parameter",
                  "off by", "the paper says", (error + ". max").c_str(), (error + ". rms").c_str(),
                  "at rest", "bounds max/rms/rest", "") +
           format("%-7s %-24s %6s  %-32s %9s %9s %9s  %-22s %s\n", "", "", "", "", "rad", "rad",
                  "rad", "rad", "");
}

std::string sweep_line(const SweepCase &one, const SweepFigures &figures)
{
    std::string verdict = !figures.bounded ? "reported" : figures.held ? "held" : "NOT HELD";
    verdict += figures.slip_full_steps == 0 ? "" : ", rotor lost";
    verdict += figures.unexpected.empty() ? "" : ", " + figures.unexpected;
    return format("%-7s %-24s %+5.0f%%  %-32s %9.2g %9.2g %9.2g  %-22s %s\n", one.figure.c_str(),
                  one.parameter.c_str(), 100 * (one.scale - 1), one.paper.c_str(), figures.max_rad,
                  figures.rms_rad, figures.rest_rad, bounds(one).c_str(), verdict.c_str());
}

std::string sweep_json(const Sweep &sweep, const std::vector<SweepFigures> &figures,
                       const std::string &numeric, std::size_t seeds)
{
    Json json;
    json["sweep"] = sweep.name;
    json["description"] = sweep.description;
    json["numeric"] = numeric;
    json["seeds"] = seeds;
    json["version"] = STEADYSTEP_VERSION;
    json["rows"] = Json::array();
    for (std::size_t i = 0; i < figures.size(); ++i) {
        const SweepCase &one = sweep.cases[i];
        Json row;
        row["figure"] = one.figure;
        row["parameter"] = one.parameter;
        row["scale"] = one.scale;
        row["scenario"] = one.scenario.name;
        row["paper"] = one.paper;
        row[sweep.error + "_error_max_rad"] = figures[i].max_rad;
        row[sweep.error + "_error_rms_rad"] = figures[i].rms_rad;
        row["position_error_rest_rad"] = figures[i].rest_rad;
        row["slip_full_steps"] = figures[i].slip_full_steps;
        row["bound_max_rad"] = one.max_rad;
        row["bound_rms_rad"] = one.rms_rad;
        row["bound_rest_rad"] = one.rest_rad;
        row["unexpected"] = figures[i].unexpected.empty() ? Json() : Json(figures[i].unexpected);
        row["held"] = figures[i].bounded ? Json(figures[i].held) : Json();
        json["rows"].push_back(row);
    }
    return json.dump(2) + "\n";
}

} // namespace scenario
