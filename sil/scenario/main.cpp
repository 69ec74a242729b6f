/* steadystep-sil: runs scenarios of the simulated drive. Exit codes: 0 all expectations held,
   1 some did not, 2 bad input. */
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <limits>
#include <memory>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fcntl.h>
#include <unistd.h>

#include "sil/scenario/batch.h"
#include "sil/scenario/campaign.h"
#include "sil/scenario/image_run.h"
#include "sil/scenario/interruption.h"
#include "sil/scenario/junit.h"
#include "sil/scenario/motor_plausibility.h"
#include "sil/scenario/motor_report.h"
#include "sil/scenario/number_formats.h"
#include "sil/scenario/output.h"
#include "sil/scenario/report.h"
#include "sil/scenario/runner.h"
#include "sil/scenario/settings_file.h"
#include "sil/scenario/shifts.h"
#include "sil/scenario/dictionary_json.h"
#include "sil/scenario/pages.h"
#include "sil/scenario/sweep.h"
#include "sil/scenario/text.h"
#include "sil/scenario/trace.h"
#include "sil/serve/server.h"

namespace fs = std::filesystem;
using namespace scenario;

namespace
{

enum ExitCode { held = 0, not_held = 1, bad_input = 2 };

struct Options {
    std::vector<std::string> scenarios, motors;
    CommandLine given;
    std::string sweep = "bendjedia-robustness";
    std::string campaign, scenario_file; /* --write-scenario */
    std::string settings_to, junit;      /* --write-settings, --junit */
    double campaign_duration_s = 0;      /* 0: the kind's own */
    bool campaign_stretch = false;
    std::string numeric, seed, seeds, out, trace = "csv", folder;
    std::string serve; /* SCENARIO; "": a drive with its defaults */
    std::string shifts;
    serve::ServeOptions serving;
    int tcp = -1, knobs_tcp = -1, can_tcp = -1; /* -1: not asked for */
    std::string can_link;
    int nodes = 1;
    bool json = false;
    unsigned jobs = default_workers();
    fs::path program;

    Catalogue catalogue() const
    {
        return Catalogue(folder, program);
    }
};

/* The seeds of one scenario. */
struct Seeds {
    std::uint64_t first, count;
};

constexpr std::uint64_t most_seeds = 1000000;
constexpr std::uint64_t largest_seed = std::numeric_limits<std::int64_t>::max(); /* as in a file */

std::uint64_t one_seed(const std::string &text)
{
    std::uint64_t seed = 0;
    const char *const end = text.data() + text.size();
    const std::from_chars_result read = std::from_chars(text.data(), end, seed);
    if (read.ec != std::errc() || read.ptr != end || seed > largest_seed) {
        throw InputError("--seed " + text + ": expected an integer in 0..." +
                         std::to_string(largest_seed));
    }
    return seed;
}

Seeds seeds_of(const Options &options, std::uint64_t default_seed)
{
    if (!options.seed.empty()) {
        return {one_seed(options.seed), 1};
    }
    if (options.seeds.empty()) {
        return {default_seed, 1};
    }
    std::uint64_t first = 0, last = 0;
    const char *const end = options.seeds.data() + options.seeds.size();
    const std::from_chars_result dash = std::from_chars(options.seeds.data(), end, first);
    const bool two = dash.ec == std::errc() && dash.ptr != end && *dash.ptr == '-';
    const std::from_chars_result rest =
        std::from_chars(two ? dash.ptr + 1 : end, end, last); /* nothing left is an error, too */
    if (rest.ec != std::errc() || rest.ptr != end || last < first || last > largest_seed ||
        last - first >= most_seeds) {
        throw InputError("--seeds " + options.seeds + ": expected A-B with A <= B, at most " +
                         std::to_string(most_seeds) + " seeds");
    }
    return {first, last - first + 1};
}

/* The format asked for, or else the first that the scenario names. */
const firmware_image &image(const Options &options, const Scenario &scenario)
{
    return *image_of(options.numeric.empty() ? scenario.numerics.front() : options.numeric);
}

/* Folder of one run below --out. */
fs::path folder_of(const Options &options, const Scenario &scenario, std::uint64_t seed)
{
    const std::string suffix = options.seeds.empty() ? "" : "-seed" + std::to_string(seed);
    return fs::path(options.out) / (scenario.name + suffix);
}

/* Runs it, and writes what comes of it. */
Result write_run(const Options &options, const Scenario &scenario, std::uint64_t seed)
{
    const fs::path folder = folder_of(options, scenario, seed);
    const std::vector<std::unique_ptr<Trace>> traces = traces_of(options.trace, folder);
    std::vector<RowReader *> readers;
    for (const std::unique_ptr<Trace> &trace : traces) {
        readers.push_back(trace.get());
    }
    Result result = execute(scenario, image(options, scenario), seed, readers);
    for (const std::unique_ptr<Trace> &trace : traces) {
        trace->finish();
    }
    write_file(folder / "summary.json", summary_json(result));
    write_file(folder / "serial.txt", result.serial);
    return result;
}

/* What stands out in the motor files, unless they say why: often a slip of a unit. */
void show_doubts(const std::vector<Scenario> &scenarios)
{
    std::set<std::string> doubts;
    for (const Scenario &scenario : scenarios) {
        for (const std::string &doubt : unexplained_doubts_about(scenario.motor)) {
            if (doubts.insert(doubt).second) {
                std::fprintf(stderr, "steadystep-sil: doubtful: %s\n", doubt.c_str());
            }
        }
    }
}

std::vector<Scenario> read_scenarios(const Options &options)
{
    const Catalogue catalogue = options.catalogue();
    std::vector<Scenario> scenarios;
    std::set<std::string> names;
    for (const std::string &name : options.scenarios) {
        scenarios.push_back(read_scenario(catalogue, name, options.given, "run"));
        if (!names.insert(scenarios.back().name).second) {
            throw InputError("run: " + name + ": given twice");
        }
        check(scenarios.back(), image(options, scenarios.back()));
        if (!options.given.image.empty()) {
            check_image(scenarios.back(), image(options, scenarios.back()).numeric);
        }
    }
    show_doubts(scenarios);
    return scenarios;
}

/* Runs every scenario with its seeds and hands each scenario's results over, in order. */
template <typename Scenarios, typename Deliver>
void run_all(const Options &options, const Scenarios &scenarios, bool write, Deliver deliver)
{
    struct Item {
        std::size_t scenario;
        std::uint64_t seed;
        bool last;
    };
    std::vector<Item> items;
    for (std::size_t i = 0; i < scenarios.size(); ++i) {
        const Seeds seeds = seeds_of(options, scenarios[i]->seed);
        for (std::uint64_t n = 0; n < seeds.count; ++n) {
            items.push_back({i, seeds.first + n, n + 1 == seeds.count});
        }
    }
    if (write) {
        prepare_folder(options.out);
    }
    std::vector<Result> results(items.size());
    std::vector<Result> of_scenario;
    run_batch(
        items.size(), options.jobs,
        [&](std::size_t i) {
            const Scenario &scenario = *scenarios[items[i].scenario];
            results[i] = write ? write_run(options, scenario, items[i].seed)
                               : execute(scenario, image(options, scenario), items[i].seed);
        },
        [&](std::size_t i) {
            of_scenario.push_back(std::move(results[i]));
            if (items[i].last) {
                deliver(items[i].scenario, of_scenario);
                of_scenario.clear();
            }
        });
}

/* Behind all checks, before the first run. */
void write_settings(const Options &options, const Scenario &scenario)
{
    if (!options.out.empty()) {
        prepare_folder(options.out); /* refused before anything is written */
    }
    write_file(options.settings_to, settings_text(scenario.drive));
}

int run_command(Options options)
{
    if (!options.settings_to.empty() && options.scenarios.size() != 1) {
        throw InputError("--write-settings " + options.settings_to + ": expected one scenario");
    }
    if (options.numeric.empty() && !options.given.image.empty()) {
        options.numeric = virtual_board::VirtualBoard::numeric_of(options.given.image);
    }
    const std::vector<Scenario> scenarios = read_scenarios(options);
    std::vector<const Scenario *> pointers;
    for (const Scenario &scenario : scenarios) {
        pointers.push_back(&scenario);
    }
    if (!options.settings_to.empty()) {
        write_settings(options, scenarios.front());
    }
    std::size_t failed = 0;
    std::vector<Result> all;
    std::vector<std::vector<Result>> by_scenario;
    run_all(options, pointers, !options.out.empty(),
            [&](std::size_t, const std::vector<Result> &results) {
                const Report one = report(results);
                failed += one.passed ? 0 : 1;
                if (!options.junit.empty()) {
                    by_scenario.push_back(results);
                }
                if (options.json) {
                    all.insert(all.end(), results.begin(), results.end());
                } else {
                    print(one.text + "\n");
                }
            });
    if (!options.junit.empty()) {
        write_file(options.junit, junit_xml(by_scenario));
    }
    if (options.json) {
        print(summaries_json(all));
    } else {
        print(format("%zu of %zu scenarios hold\n", scenarios.size() - failed, scenarios.size()));
    }
    return failed == 0 ? held : not_held;
}

int sweep_command(Options options)
{
    if (options.numeric.empty()) {
        options.numeric = "float";
    }
    const Catalogue catalogue = options.catalogue();
    const Sweep sweep = read_sweep(catalogue, catalogue.sweep(options.sweep, "sweep"));
    std::vector<const Scenario *> pointers;
    for (const SweepCase &one : sweep.cases) {
        check(one.scenario, image(options, one.scenario));
        pointers.push_back(&one.scenario);
    }
    const std::uint64_t seeds = seeds_of(options, 1).count;
    if (!options.out.empty()) {
        prepare_folder(options.out);
    }
    print(sweep.description + "\n" + options.numeric +
          format(", %llu seed%s; 95th percentiles\n\n", static_cast<unsigned long long>(seeds),
                 seeds == 1 ? "" : "s") +
          sweep_heading(sweep));
    std::vector<SweepFigures> figures;
    std::size_t failed = 0;
    run_all(options, pointers, false, [&](std::size_t i, const std::vector<Result> &results) {
        figures.push_back(figures_of(sweep.cases[i], results));
        print(sweep_line(sweep.cases[i], figures.back()));
        if (!figures.back().held) {
            ++failed;
            print("  reproduce: " +
                  reproduce_command(sweep.cases[i].scenario, options.numeric, results[0].seed) +
                  "\n");
        }
    });
    if (!options.out.empty()) {
        write_file(fs::path(options.out) / "table.json",
                   sweep_json(sweep, figures, options.numeric, seeds));
    }
    return failed == 0 ? held : not_held;
}

const CampaignKind &campaign_kind(const std::string &name)
{
    for (const CampaignKind *kind : campaign_kinds()) {
        if (name == kind->name) {
            return *kind;
        }
    }
    throw InputError("campaign " + name + ": unknown kind (steadystep-sil list names them)");
}

/* What the kind has a use for. */
void require_fitting(const Options &options, const CampaignKind &kind)
{
    if (options.campaign_duration_s > 0 && kind.duration_s == CampaignKind::own_duration) {
        throw InputError(std::string("--duration: each run of ") + kind.name + " has its own");
    }
    if (options.campaign_stretch && !kind.has_bounds) {
        throw InputError(
            std::string("--stretch: ") + kind.name +
            " draws no tolerances within bounds; as-built, as-built-corners and as-built-loads do");
    }
}

int campaign_command(const Options &options)
{
    const Catalogue catalogue = options.catalogue();
    CampaignOrder order;
    order.kind = &campaign_kind(options.campaign);
    require_fitting(options, *order.kind);
    const bool given = !options.seed.empty() || !options.seeds.empty();
    const Seeds seeds = given ? seeds_of(options, 1) : Seeds{1, order.kind->seeds};
    order.duration_s =
        options.campaign_duration_s > 0 ? options.campaign_duration_s : order.kind->duration_s;
    order.first_seed = seeds.first;
    order.seeds = seeds.count;
    order.numeric = options.numeric.empty() ? "float" : options.numeric;
    order.given = options.given;
    order.out = options.out;
    order.motor = campaign_motor(catalogue, *order.kind, order.given);
    order.motor.spread = options.campaign_stretch ? 2 : 1;
    order.jobs = options.jobs;
    order.json = options.json;
    if (options.scenario_file.empty()) {
        return run_campaign(catalogue, order) ? held : not_held;
    }
    const auto of_motor = [](const std::string &setting) {
        return setting.rfind("motor=", 0) == 0;
    };
    const std::vector<std::string> &settings = order.given.settings;
    if (order.seeds != 1 || !std::all_of(settings.begin(), settings.end(), of_motor) ||
        !order.given.parameters.empty()) {
        throw InputError("--write-scenario: expected one seed, no --parameters, and of --set "
                         "nothing but motor=");
    }
    write_drawn(order, options.scenario_file);
    return held;
}

/* What is served unless a scenario is named. */
constexpr const char *served_alone = "description = \"a drive with its defaults\"\n"
                                     "motor = \"bendjedia-2012\"\n"
                                     "duration_s = 1\n"
                                     "plant.model = \"bench\"\n";

int serve_command(Options options)
{
    const Catalogue catalogue = options.catalogue();
    Scenario scenario = options.serve.empty()
                            ? read_scenario_text(catalogue, served_alone, "serve", options.given)
                            : read_scenario(catalogue, options.serve, options.given, "serve");
    scenario.events.clear(); /* it is for its clients to act */
    if (options.numeric.empty() && !options.given.image.empty()) {
        options.numeric = virtual_board::VirtualBoard::numeric_of(options.given.image);
    }
    const firmware_image &firmware = image(options, scenario);
    const std::uint64_t seed = seeds_of(options, scenario.seed).first;
    check(scenario, firmware);
    show_doubts({scenario});
    if (options.tcp >= 0) {
        options.serving.serial.tcp = static_cast<unsigned>(options.tcp);
    }
    if (options.knobs_tcp >= 0) {
        options.serving.knobs.tcp = static_cast<unsigned>(options.knobs_tcp);
    }
    if (!options.can_link.empty() || options.can_tcp >= 0) {
        if (options.given.image.empty()) {
            throw InputError("--can-link, --can-tcp: expected --image, the simulated board has no "
                             "CAN bus");
        }
        options.serving.can = serve::PortPlace{options.can_link, {}};
        if (options.can_tcp >= 0) {
            options.serving.can->tcp = static_cast<unsigned>(options.can_tcp);
        }
    }
    if (!options.given.image.empty()) {
        check_image(scenario, firmware.numeric);
    }
    std::vector<std::unique_ptr<sil::DriveBoard>> boards;
    for (int node = 1; node <= options.nodes; ++node) {
        if (options.nodes > 1) {
            scenario.drive.node_id = node;
        }
        const plant::Config plant = plant_of(scenario, seed + static_cast<unsigned>(node) - 1);
        if (options.given.image.empty()) {
            boards.push_back(
                sil::Board::flashed(plant, firmware, scenario.drive, scenario.comparator_trip_A));
        } else {
            boards.push_back(std::make_unique<virtual_board::VirtualBoard>(
                plant, options.given.image, firmware.numeric, scenario.drive));
        }
    }
    serve::Server server(scenario, std::move(boards), options.serving);
    print(server.places());
    print(server.run());
    return held;
}

int shifts_command(const Options &options)
{
    print(coefficient_shifts(
        read_scenario(options.catalogue(), options.shifts, options.given, "shifts")));
    return held;
}

/* As it is asked for by name. */
std::string name_of(const fs::path &file)
{
    const fs::path folder = file.parent_path();
    const bool set = folder.parent_path().filename() == "parameters";
    return set ? (folder.filename() / file.stem()).string() : file.stem().string();
}

std::string gains_of(position_law law)
{
    std::string names;
    const char *name = nullptr;
    for (std::size_t i = 0; (name = firmware_image_float.law_gain(law, i)) != nullptr; ++i) {
        names += (i == 0 ? "" : " ") + std::string(name);
    }
    return names;
}

int list_command(const Options &options)
{
    const Catalogue catalogue = options.catalogue();
    std::string lines, complaints;
    const auto entry = [&](const std::string &name, const std::string &description) {
        lines += format("  %-32s ", name.c_str()) + description + "\n";
    };
    const auto list = [&](const char *heading, const std::vector<fs::path> &files,
                          const auto &describe) {
        lines += std::string(heading) + "\n";
        for (const fs::path &file : files) {
            try {
                entry(name_of(file), describe(file));
            } catch (const InputError &error) {
                complaints += std::string("steadystep-sil: ") + error.what() + "\n";
            }
        }
    };
    list("scenarios", catalogue.scenarios(), [&](const fs::path &file) {
        return read_scenario(catalogue, file.string(), {}, "list").description;
    });
    list("sweeps", catalogue.sweeps(),
         [&](const fs::path &file) { return read_sweep(catalogue, file).description; });
    list("motors", catalogue.motors(),
         [](const fs::path &file) { return read_motor(file).description; });
    list("parameters", catalogue.parameters(),
         [](const fs::path &file) { return read_parameters(file).description; });
    lines += "campaigns\n";
    for (const CampaignKind *kind : campaign_kinds()) {
        entry(kind->name, kind->description);
    }
    lines += "laws, and the gains that can be given to them\n";
    for (int law = 0; law < POSITION_LAW_COUNT; ++law) {
        entry(drive_law_name(static_cast<position_law>(law)),
              gains_of(static_cast<position_law>(law)));
    }
    print(lines);
    std::fputs(complaints.c_str(), stderr);
    return complaints.empty() ? held : bad_input;
}

int dictionary_command(const Options &options)
{
    std::vector<Motor> motors;
    for (const fs::path &file : options.catalogue().motors()) {
        motors.push_back(read_motor(file));
    }
    print(dictionary_json(motors));
    return held;
}

int check_motor_command(const Options &options)
{
    const Catalogue catalogue = options.catalogue();
    std::vector<Motor> motors;
    bool doubtful = false;
    for (const std::string &name : options.motors) {
        motors.push_back(read_motor(catalogue.motor(name, "check-motor", {})));
        doubtful = doubtful || !unexplained_doubts_about(motors.back()).empty();
    }
    if (options.json) {
        print(motors_json(motors));
    } else {
        for (const Motor &motor : motors) {
            print(motor_report(motor));
        }
    }
    return doubtful ? not_held : held;
}

/* A NaN lies in every range. */
CLI::Validator finite()
{
    return {[](const std::string &text) {
                return std::isfinite(std::strtod(text.c_str(), nullptr))
                           ? std::string()
                           : std::string("expected a finite number");
            },
            ""};
}

CLI::Validator not_empty()
{
    return {[](const std::string &text) {
                return text.empty() ? std::string("expected a text that is not empty")
                                    : std::string();
            },
            ""};
}

/* Options that `run` and `sweep` share. */
void add_run_options(CLI::App &command, Options &options)
{
    command
        .add_option("--numeric", options.numeric,
                    "number format of the drive; else the scenario's first, float as a rule")
        ->check(CLI::IsMember(number_formats()));
    CLI::Option *seed =
        command.add_option("--seed", options.seed, "seed of all noise")->check(not_empty());
    CLI::Option *seeds = command
                             .add_option("--seeds", options.seeds,
                                         "A-B: one run per seed, the 95th percentile decides")
                             ->check(not_empty());
    seed->excludes(seeds);
    command.add_option("--out", options.out, "folder that receives the results")
        ->check(not_empty());
    command.add_option("--jobs", options.jobs, "runs at a time; changes no result")
        ->check(CLI::Range(1u, 256u))
        ->capture_default_str();
}

/* Options that `run` and `campaign` share. */
void add_given_options(CLI::App &command, Options &options)
{
    command.add_option("--set", options.given.settings, "table.key=value, on top of every file")
        ->allow_extra_args(false);
    command
        .add_option("--parameters", options.given.parameters,
                    "parameter set, on top of every file and below --set")
        ->check(not_empty());
}

void add_serve_options(CLI::App &command, Options &options)
{
    serve::ServeOptions &serving = options.serving;
    command.add_option("SCENARIO", options.serve,
                       "name or path: its motor, plant and drive, without its events; else the "
                       "reference motor on `bench`");
    add_given_options(command, options);
    command.add_option("--numeric", options.numeric, "number format of the drive")
        ->check(CLI::IsMember(number_formats()));
    command.add_option("--seed", options.seed, "seed of all noise")->check(not_empty());
    command.add_option("--image", options.given.image, "image of the STM32G474 board, an .elf")
        ->check(CLI::ExistingFile);
    command.add_option("--speed", serving.speed, "simulated seconds in a second")
        ->check(CLI::Range(0.001, 1000.0))
        ->check(finite());
    command.add_option("--baud", serving.baud, "of the serial line")
        ->check(CLI::Range(1200.0, 1e7))
        ->check(finite());
    command.add_option("--nodes", options.nodes, "drives on one bus, with numbers from 1 on")
        ->check(CLI::Range(1, 16));
    command.add_option("--link", serving.serial.link, "symbolic link to the pseudo-terminal")
        ->check(not_empty());
    command.add_option("--tcp", options.tcp, "port on 127.0.0.1 for the same bytes; 0: a free one")
        ->check(CLI::Range(0, 65535));
    command
        .add_option("--can-link", options.can_link,
                    "of --image: a CAN adapter (slcan) on the board's bus, its pseudo-terminal")
        ->check(not_empty());
    command.add_option("--can-tcp", options.can_tcp, "the same adapter, port on 127.0.0.1")
        ->check(CLI::Range(0, 65535));
    command.add_option("--knobs-link", serving.knobs.link, "the same for the knobs")
        ->check(not_empty());
    command.add_option("--knobs-tcp", options.knobs_tcp, "the same for the knobs")
        ->check(CLI::Range(0, 65535));
}

int run_program(int argc, char **argv)
{
    Options options;
    std::error_code unknown;
    options.program = fs::read_symlink("/proc/self/exe", unknown);
    if (unknown) {
        options.program = argv[0];
    }

    CLI::App app{"steadystep-sil: the drive's own firmware on a simulated board and motor.\n"
                 "Exit code 0: all expectations held, 1: some did not, 2: bad input.",
                 "steadystep-sil"};
    app.set_version_flag("--version", "steadystep-sil " STEADYSTEP_VERSION);
    app.require_subcommand(1);
    app.add_option("--scenarios", options.folder, "folder of scenarios; motors in ../motors")
        ->envname("STEADYSTEP_SCENARIOS");
    app.fallthrough();

    CLI::App *run = app.add_subcommand("run", "run scenarios and judge them");
    run->add_option("SCENARIO", options.scenarios, "names or paths")->required();
    add_given_options(*run, options);
    run->add_flag("--typed", options.given.typed,
                  "commands go to the drive as typed lines; time zero is 21 periods later");
    run->add_option("--image", options.given.image,
                    "image of the STM32G474 board, an .elf with its .map.json beside it: runs on "
                    "the virtual board, with typed lines")
        ->check(CLI::ExistingFile);
    run->add_option("--settings", options.given.settings_file,
                    "file of settings, on top of scenario, motor and --parameters, below --set")
        ->check(not_empty());
    run->add_option("--write-settings", options.settings_to,
                    "file that receives the settings given to the drive")
        ->check(not_empty());
    run->add_option("--junit", options.junit,
                    "file that receives the verdicts as JUnit XML, a case per run")
        ->check(not_empty());
    run->add_option("--trace", options.trace,
                    "traces that --out receives: text, or doubles as NumPy keeps them")
        ->check(CLI::IsMember({"csv", "npy", "both", "none"}))
        ->capture_default_str();
    run->add_flag("--json", options.json, "one array of summaries on standard output, no report");
    add_run_options(*run, options);
    CLI::App *sweep = app.add_subcommand("sweep", "run a table of plant parameters");
    sweep->add_option("SWEEP", options.sweep, "name or path")->capture_default_str();
    add_run_options(*sweep, options);
    CLI::App *campaign =
        app.add_subcommand("campaign", "run scenarios drawn at random, one per seed");
    campaign->add_option("KIND", options.campaign, "as `list` names them")->required();
    campaign->add_option("--duration", options.campaign_duration_s, "of one run, s")
        ->check(CLI::Range(0.1, 600.0))
        ->check(finite());
    campaign
        ->add_option("--write-scenario", options.scenario_file,
                     "writes the scenario of --seed to this file and runs nothing")
        ->check(not_empty());
    campaign->add_flag("--stretch", options.campaign_stretch,
                       "doubles the bounds of tolerances, where a kind has such");
    campaign->add_flag("--json", options.json, "JSON on standard output, no report");
    add_given_options(*campaign, options);
    add_run_options(*campaign, options);
    CLI::App *serve =
        app.add_subcommand("serve", "let a simulated drive live in real time behind a serial line");
    add_serve_options(*serve, options);
    CLI::App *shifts = app.add_subcommand(
        "shifts", "the header of an image for one motor, in fixed point (firmware/README.md)");
    shifts->add_option("SCENARIO", options.shifts, "name or path: its motor and drive")->required();
    add_given_options(*shifts, options);
    CLI::App *check_motor = app.add_subcommand(
        "check-motor", "say what motor files mean and whether their values go together");
    check_motor->add_option("MOTOR", options.motors, "names or paths")->required();
    check_motor->add_flag("--json", options.json, "one array of motors, nothing else");
    CLI::App *list = app.add_subcommand(
        "list", "scenarios, sweeps, motors, parameter sets and laws, in one line each");
    CLI::App *dictionary = app.add_subcommand(
        "dictionary", "settings, commands, signals, faults and motors for programs, as JSON");
    for (const Page &page : pages()) {
        app.add_subcommand(page.name, page.about);
    }

    try {
        app.parse(argc, argv);
        if (*list) {
            return list_command(options);
        }
        for (const Page &page : pages()) {
            if (app.got_subcommand(page.name)) {
                print(page.text());
                return held;
            }
        }
        if (*dictionary) {
            return dictionary_command(options);
        }
        if (*check_motor) {
            return check_motor_command(options);
        }
        if (*campaign) {
            return campaign_command(options);
        }
        if (*serve) {
            return serve_command(options);
        }
        if (*shifts) {
            return shifts_command(options);
        }
        return *run ? run_command(options) : sweep_command(options);
    } catch (const CLI::Success &asked) {
        std::ostringstream text; /* of --help, --version */
        const int code = app.exit(asked, text);
        print(text.str());
        return code;
    } catch (const CLI::ParseError &error) {
        std::fprintf(stderr, "steadystep-sil: %s (see --help)\n", error.what());
    }
    return bad_input;
}

/* Without it, what is printed would end up in the first file that is opened. */
void require_standard_output()
{
    if (fcntl(STDOUT_FILENO, F_GETFD) < 0) {
        throw InputError("standard output: is closed");
    }
}

} // namespace

int main(int argc, char **argv)
{
    try {
        note_signals();
        require_standard_output();
        return run_program(argc, argv);
    } catch (const Interrupted &interrupted) {
        std::fprintf(stderr, "steadystep-sil: interrupted: %s\n", interrupted.what());
        end_by_signal();
    } catch (const std::exception &error) { /* InputError, and what the machine refuses */
        std::fprintf(stderr, "steadystep-sil: %s\n", in_one_line(error.what()).c_str());
        return bad_input;
    }
}
