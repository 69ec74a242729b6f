#include "sil/scenario/timeline.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "firmware/interface/dictionary.h"
#include "sil/scenario/metrics.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr std::int64_t most_incidents = 1000000;
constexpr double largest_bound = 1e12; /* of an expectation; any finite number in practice */
constexpr double largest_position_rad = 1e7;
constexpr double largest_short_circuit_A = 100;
constexpr double shortest_stall_us = 10; /* what the interrupt takes anyway */
constexpr double longest_stall_us = 120; /* the next control interrupt still gets its samples */

constexpr const char *power_cycle = "power-cycle"; /* of the board, not to the drive */

/* One position per line; empty lines and what follows a # count for nothing. */
std::vector<double> read_positions(const std::filesystem::path &file, const std::string &asked_by)
{
    std::ifstream stream(file);
    if (!stream) {
        throw InputError(asked_by + ": cannot read " + file.string());
    }
    std::vector<double> positions;
    std::string line;
    for (std::size_t number = 1; std::getline(stream, line); ++number) {
        const std::string text = line.substr(0, line.find('#'));
        const std::size_t begin = text.find_first_not_of(" \t\r");
        if (begin == std::string::npos) {
            continue;
        }
        const std::size_t end = text.find_last_not_of(" \t\r") + 1;
        double value = 0;
        const auto result = std::from_chars(text.data() + begin, text.data() + end, value);
        if (result.ec != std::errc() || result.ptr != text.data() + end ||
            !(std::fabs(value) <= largest_position_rad)) {
            throw InputError(file.string() + ":" + std::to_string(number) +
                             ": expected one position in rad, -1e7...1e7");
        }
        positions.push_back(value);
    }
    return positions;
}

/* `positions_rad` or the lines of `file`; the last one three times, which ends the stream. */
std::vector<double> read_set_points(TableReader &reader, const Location &event)
{
    const Value *list = reader.array("positions_rad");
    std::string file;
    std::vector<double> positions;
    if (reader.text("file", file) == (list != nullptr)) {
        reader.fail("positions_rad", "expected exactly one of positions_rad, file");
    }
    if (list != nullptr) {
        for (const Value &item : list->items) {
            if ((item.kind != Value::Kind::number && item.kind != Value::Kind::integer) ||
                !(std::fabs(item.number) <= largest_position_rad)) {
                reader.fail("positions_rad", "expected numbers in -1e7...1e7");
            }
            positions.push_back(item.number);
        }
    } else {
        positions = read_positions(std::filesystem::path(event.file).parent_path() / file,
                                   event.text() + ": file");
    }
    if (positions.empty()) {
        reader.fail(list != nullptr ? "positions_rad" : "file", "expected at least one position");
    }
    positions.insert(positions.end(), 2, positions.back());
    return positions;
}

/* What is absurd is kept out, of a move what its time and its other times do not leave either; the
   drive knows its own limits and refuses with its own text. */
std::pair<double, double> range_of(const parameter_row &parameter, const drive_command &command,
                                   double time_left_s)
{
    if (drive_command_is(command.kind, DRIVE_PROFILE)) {
        switch (&parameter - parameter_at(drive_parameter{})) {
        case DRIVE_PARAMETER_duration_s:
            return {parameter.least, std::max(parameter.least, time_left_s)};
        case DRIVE_PARAMETER_ramp_s:
            return {1e-4, command.duration_s / 2};
        case DRIVE_PARAMETER_jerk_s:
            return {parameter.least, command.ramp_s / 2};
        default:
            break;
        }
    }
    return {parameter.least, parameter.most};
}

/* An event gives all parameters, those that are optional on the console, too. */
drive_command read_command(TableReader &reader, double time_left_s)
{
    std::vector<std::string> names;
    for (int kind = 0; kind < DRIVE_COMMANDS; ++kind) {
        names.push_back(command_name(static_cast<drive_command_kind>(kind)));
    }
    names.push_back(power_cycle);
    std::size_t index = 0;
    reader.choice("command", index, names);

    drive_command command{};
    command.kind = static_cast<drive_command_kind>(index);
    const struct parameter_row *parameter = nullptr;
    for (std::size_t i = 0; (parameter = parameter_of(command.kind, i)) != nullptr; ++i) {
        if (command.kind == DRIVE_COMMAND_SET_POINT &&
            parameter->offset == offsetof(drive_command, position_rad)) {
            continue; /* positions_rad or a file has them */
        }
        const auto [least, most] = range_of(*parameter, command, time_left_s);
        double value = 0;
        reader.require(parameter->name);
        reader.number(parameter->name, value, least, most);
        parameter_put(&command, parameter, value);
    }
    return command;
}

void read_short_circuit(TableReader &reader, Event &event)
{
    std::size_t leg = 0;
    reader.choice("short_circuit", leg, {"A+", "A-", "B+", "B-"});
    event.shorted_leg = static_cast<int>(leg);
    reader.require("short_circuit_A");
    reader.number("short_circuit_A", event.short_circuit_A, 0, largest_short_circuit_A);
}

std::string listed(const std::vector<std::string> &names)
{
    std::string text;
    for (const std::string &name : names) {
        text += (text.empty() ? "" : ", ") + name;
    }
    return text;
}

Event read_event(const Value &table, const std::string &path, double duration_s)
{
    TableReader reader(table, path);
    Event event;
    event.location = table.location;
    reader.require("time_s");
    reader.number("time_s", event.time_s, 0, duration_s);
    const Value *command = reader.any("command");
    const Value *plant = reader.table("plant");
    const bool has_load = reader.any(load_torque_key) != nullptr;
    const bool has_vibration = reader.any(load_vibration_key) != nullptr;
    const bool has_short_circuit = reader.any("short_circuit") != nullptr;
    std::int64_t inputs = 0;
    if (reader.integer("inputs", inputs, 0, HAL_INPUTS)) {
        event.inputs = static_cast<std::uint32_t>(inputs);
    }
    double stall_us = 0;
    if (reader.number("stall_us", stall_us, shortest_stall_us, longest_stall_us)) {
        event.stall_us = stall_us;
    }
    for (const std::string &name : plant_fault_names()) {
        if (reader.any(name) != nullptr) {
            if (event.fault) {
                reader.fail(name, "expected one fault per event");
            }
            event.fault = read_plant_fault(reader, name);
        }
    }
    std::string typed, expected;
    if (reader.text("type", typed)) {
        event.type = typed;
    }
    if (reader.text("expect", expected)) {
        event.expects = expected;
    }
    if ((command != nullptr) + (plant != nullptr) + has_load + has_vibration +
            event.type.has_value() + event.expects.has_value() + has_short_circuit +
            event.stall_us.has_value() + event.inputs.has_value() +
            static_cast<bool>(event.fault) !=
        1) {
        reader.fail("command", "expected exactly one of command, type, expect, load_torque_Nm, "
                               "load_vibration_Nm, plant.<key>, short_circuit, stall_us, inputs, " +
                                   listed(plant_fault_names()));
    }
    if (command != nullptr && command->kind == Value::Kind::text && command->text == power_cycle) {
        event.power_cycle = true;
    } else if (command != nullptr) {
        event.command = read_command(reader, duration_s - event.time_s);
        if (event.command->kind == DRIVE_COMMAND_SET_POINT) {
            event.set_points_rad = read_set_points(reader, event.location);
            event.command->position_rad = event.set_points_rad.front();
        }
    } else if (event.type || event.expects || event.stall_us || event.inputs || event.fault) {
        reader.finish();
        return event;
    } else if (has_short_circuit) {
        read_short_circuit(reader, event);
    } else if (plant != nullptr) {
        event.drifts = read_drifts(*plant, path);
        reader.number("ramp_s", event.drift_ramp_s, 0, longest_ramp_s);
    } else {
        event.load = read_load_change(reader);
    }
    reader.finish();
    return event;
}

Window read_window(TableReader &reader, double duration_s)
{
    Window window;
    const Value *value = reader.any("window");
    if (value == nullptr) {
        return window;
    }
    const std::string expected =
        "expected \"move\", \"rest\", \"all\" or [begin, end] in s with 0 <= begin < end <= " +
        readable(duration_s);
    if (value->kind == Value::Kind::text) {
        if (value->text == "move") {
            window.kind = Window::Kind::move;
        } else if (value->text == "rest") {
            window.kind = Window::Kind::rest;
        } else if (value->text != "all") {
            reader.fail("window", expected + ", got \"" + value->text + "\"");
        }
        return window;
    }
    const auto is_number = [](const Value &item) {
        return item.kind == Value::Kind::number || item.kind == Value::Kind::integer;
    };
    if (value->kind != Value::Kind::array || value->items.size() != 2 ||
        !is_number(value->items[0]) || !is_number(value->items[1])) {
        reader.fail("window", expected);
    }
    window.kind = Window::Kind::times;
    window.begin_s = value->items[0].number;
    window.end_s = value->items[1].number;
    if (!(window.begin_s >= 0 && window.begin_s < window.end_s && window.end_s <= duration_s)) {
        reader.fail("window", expected + ", got [" + readable(window.begin_s) + ", " +
                                  readable(window.end_s) + "]");
    }
    return window;
}

/* One fault, or an array of which one must have come. */
std::vector<std::string> read_faults(TableReader &reader)
{
    const std::vector<std::string> faults = names_of(drive_fault_name, DRIVE_FAULTS);
    reader.require("equals");
    const Value *value = reader.any("equals");
    if (value->kind != Value::Kind::array) {
        std::size_t fault = 0;
        reader.choice("equals", fault, faults);
        return {faults[fault]};
    }
    std::vector<std::string> chosen;
    for (const Value &item : value->items) {
        if (item.kind != Value::Kind::text ||
            std::find(faults.begin(), faults.end(), item.text) == faults.end()) {
            reader.fail("equals", "expected " + one_of(item.text, faults));
        }
        chosen.push_back(item.text);
    }
    if (chosen.empty()) {
        reader.fail("equals", "expected at least one fault");
    }
    return chosen;
}

/* What a run must not do unless just so much of it is expected; `fault` is the third of them. */
bool is_count_of_incidents(const std::string &metric)
{
    return metric == "commands_refused" || metric == "commands_dropped";
}

Expectation read_expectation(const Value &table, const std::string &path, double duration_s)
{
    TableReader reader(table, path);
    Expectation expectation;
    std::vector<std::string> metrics = {"fault"};
    for (const MetricField &field : metric_fields()) {
        metrics.push_back(field.name);
    }
    std::size_t metric = 0;
    reader.require("metric");
    reader.choice("metric", metric, metrics);
    expectation.metric = metrics[metric];
    expectation.window = read_window(reader, duration_s);

    if (expectation.metric == "fault") {
        expectation.equals_text = read_faults(reader);
    } else if (is_count_of_incidents(expectation.metric)) {
        std::int64_t count = 0;
        reader.require("equals");
        reader.integer("equals", count, 0, most_incidents);
        expectation.equals = static_cast<double>(count);
    } else {
        const auto bound = [&](const char *key, std::optional<double> &target) {
            double value = 0;
            if (reader.number(key, value, -largest_bound, largest_bound)) {
                target = value;
            }
        };
        bound("min", expectation.min);
        bound("max", expectation.max);
        bound("equals", expectation.equals);
        if (!expectation.min && !expectation.max && !expectation.equals) {
            reader.fail("max", "is missing: expected at least one of max, min, equals");
        }
    }
    reader.finish();
    return expectation;
}

Expectation read_report(const Value &table, const std::string &path, double duration_s)
{
    TableReader reader(table, path);
    std::vector<std::string> metrics;
    for (const MetricField &field : metric_fields()) {
        metrics.push_back(field.name);
    }
    std::size_t metric = 0;
    Expectation report;
    reader.require("metric");
    reader.choice("metric", metric, metrics);
    report.metric = metrics[metric];
    report.window = read_window(reader, duration_s);
    reader.finish();
    return report;
}

/* "event[1]": the place in an array of tables, from 1. */
std::string element(const std::string &array, std::size_t index)
{
    return array + "[" + std::to_string(index + 1) + "]";
}

} // namespace

std::string command_name(drive_command_kind kind)
{
    return std::string(drive_command_name(kind)) + (kind == DRIVE_COMMAND_SET_POINT ? "s" : "");
}

std::string Expectation::bound() const
{
    if (of_fault()) {
        std::string names;
        for (const std::string &name : equals_text) {
            names += (names.empty() ? "= " : " or ") + name;
        }
        return names;
    }
    if (equals) {
        return "= " + readable(*equals);
    }
    if (min && max) {
        return readable(*min) + "..." + readable(*max);
    }
    return max ? "<= " + readable(*max) : ">= " + readable(*min);
}

std::vector<Event> read_events(TableReader &scenario, double duration_s)
{
    std::vector<Event> events;
    if (const Value *tables = scenario.array("event")) {
        for (std::size_t i = 0; i < tables->items.size(); ++i) {
            events.push_back(read_event(tables->items[i], element("event", i), duration_s));
        }
    }
    std::stable_sort(events.begin(), events.end(),
                     [](const Event &a, const Event &b) { return a.time_s < b.time_s; });
    return events;
}

Event read_knob(const std::string &line, const std::string &name)
{
    const Value document = parse_toml("knob = { time_s = 0, " + line + " }", name);
    const Event event = read_event(*document.find("knob"), "knob", 0);
    if (document.keys.size() != 1 || event.command || event.type || event.expects) {
        throw InputError(name + ": expected a load, plant.<key>, a fault, or command = "
                                "\"power-cycle\"; what is for the drive goes to its serial line");
    }
    return event;
}

std::vector<Expectation> read_expectations(TableReader &scenario, double duration_s)
{
    std::vector<Expectation> expectations;
    if (const Value *tables = scenario.array("expect")) {
        for (std::size_t i = 0; i < tables->items.size(); ++i) {
            expectations.push_back(
                read_expectation(tables->items[i], element("expect", i), duration_s));
        }
    }
    return expectations;
}

std::vector<Expectation> read_reports(TableReader &scenario, double duration_s)
{
    std::vector<Expectation> reports;
    if (const Value *tables = scenario.array("report")) {
        for (std::size_t i = 0; i < tables->items.size(); ++i) {
            reports.push_back(read_report(tables->items[i], element("report", i), duration_s));
        }
    }
    return reports;
}

} // namespace scenario
