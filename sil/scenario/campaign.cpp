#include "sil/scenario/campaign.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <filesystem>

#include "sil/scenario/batch.h"
#include "sil/scenario/campaign_journal.h"
#include "sil/scenario/campaign_report.h"
#include "sil/scenario/number_formats.h"
#include "sil/scenario/output.h"
#include "sil/scenario/table_reader.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace fs = std::filesystem;

namespace
{

/* The first word of a refusal that is a name, for the report to count by. */
std::string refused_quantity(const std::string &text)
{
    std::string word;
    for (const char letter : text.substr(text.find(": ") + 1) + " ") {
        if (std::isalnum(static_cast<unsigned char>(letter)) != 0 || letter == '_') {
            word += letter;
            continue;
        }
        if (word.find('_') != std::string::npos) {
            return word;
        }
        word.clear();
    }
    return "for another reason";
}

CampaignRun refused(const CampaignKind &kind, std::uint64_t seed, const std::string &text)
{
    CampaignRun run;
    run.seed = seed;
    run.outcome.verdict = "refused: " + refused_quantity(text);
    run.outcome.figures.assign(kind.figures.size(), Metrics::none);
    run.failure = text;
    return run;
}

CampaignRun executed(const CampaignOrder &order, const Scenario &scenario, std::uint64_t seed)
{
    const std::unique_ptr<CampaignWatch> watch = order.kind->watch(scenario);
    const Result result = execute(scenario, *image_of(order.numeric), scenario.seed, {watch.get()});
    CampaignRun run;
    run.seed = seed;
    run.outcome = watch->judge(result);
    run.failure = result.not_as_described();
    run.trace_hash = result.trace_hash;
    run.drive_hash = result.drive_hash;
    run.simulated_s = result.simulated_s;
    return run;
}

CampaignRun ran(const Catalogue &catalogue, const CampaignOrder &order, std::uint64_t seed)
{
    if (!order.kind->draws_motor) {
        return executed(order, drawn_scenario(catalogue, order, seed), seed);
    }
    Scenario scenario;
    try {
        scenario = drawn_scenario(catalogue, order, seed);
        check(scenario, *image_of(order.numeric));
    } catch (const InputError &refusal) {
        return refused(*order.kind, seed, refusal.what());
    }
    return executed(order, scenario, seed);
}

/* Throws InputError. Where motors are drawn, any may be refused; what is given is tried on the
   reference motor. */
void check_order(const Catalogue &catalogue, const CampaignOrder &order)
{
    const firmware_image &image = *image_of(order.numeric);
    if (!order.kind->draws_motor) {
        check(drawn_scenario(catalogue, order, order.first_seed), image);
        return;
    }
    const std::string text = "description = \"what is given\"\nmotor = \"" + CampaignMotor{}.name +
                             "\"\nduration_s = 1\n";
    check(read_scenario_text(catalogue, text, order.kind->name, order.given), image);
}

} // namespace

const std::vector<const CampaignKind *> &campaign_kinds()
{
    static const std::vector<const CampaignKind *> kinds = {
        &long_run_campaign,
        &slip_campaign,
        &load_campaign,
        &as_built_campaign,
        &as_built_corners_campaign,
        &as_built_loads_campaign,
        &motors_campaign,
        &any_motors_campaign,
    };
    return kinds;
}

Scenario drawn_scenario(const Catalogue &catalogue, const CampaignOrder &order, std::uint64_t seed)
{
    const std::string name = std::string(order.kind->name) + "-" + std::to_string(seed);
    const Drawn drawn = order.kind->draw(seed, order.duration_s, order.motor);
    if (drawn.motor.empty()) {
        return read_scenario_text(catalogue, drawn.scenario, name, order.given);
    }
    const Motor motor = read_motor_text(drawn.motor, drawn.motor_id);
    return read_scenario_text(catalogue, drawn.scenario, name, order.given, &motor);
}

CampaignMotor campaign_motor(const Catalogue &catalogue, const CampaignKind &kind,
                             const CommandLine &given)
{
    CampaignMotor motor;
    Value settings;
    apply_settings(settings, with_plant_spelled_out(given.settings));
    const Value *const named = settings.find("motor");
    if (named == nullptr) {
        return motor;
    }
    const std::string where = named->location.text();
    if (kind.draws_motor) {
        throw InputError(where + ": the campaign " + kind.name + " draws its motors");
    }
    const auto ratings = [&](const std::string &name) {
        return ratings_of(read_motor(catalogue.motor(name, where, {})).params);
    };
    const Ratings reference = ratings(motor.name);
    TableReader(settings, "").text("motor", motor.name);
    const Ratings own = ratings(motor.name);
    if (own.speed_rad_s == 0) {
        throw InputError(where + ": its supply does not drive its rated current");
    }
    motor.scales = scales_of(own, reference);
    return motor;
}

void write_drawn(const CampaignOrder &order, const std::string &file)
{
    const fs::path folder = fs::path(file).parent_path();
    CampaignMotor motor = order.motor;
    if (is_path(motor.name)) { /* from the present folder; a scenario's is from its own */
        motor.name =
            (fs::path(".") / fs::relative(motor.name, folder.empty() ? "." : folder)).string();
    }
    const Drawn drawn = order.kind->draw(order.first_seed, order.duration_s, motor);
    write_file(file, drawn.scenario);
    if (!drawn.motor.empty()) {
        write_file(folder / (drawn.motor_id + ".toml"), drawn.motor);
    }
}

bool run_campaign(const Catalogue &catalogue, const CampaignOrder &order)
{
    check_order(catalogue, order);
    CampaignJournal journal(catalogue, order);
    std::vector<std::uint64_t> missing;
    for (std::uint64_t n = 0; n < order.seeds; ++n) {
        if (journal.find(order.first_seed + n) == nullptr) {
            missing.push_back(order.first_seed + n);
        }
    }
    if (missing.size() < order.seeds) {
        std::fprintf(stderr, "steadystep-sil: %zu of %llu runs are in %s already\n",
                     static_cast<std::size_t>(order.seeds) - missing.size(),
                     static_cast<unsigned long long>(order.seeds), journal.file().c_str());
    }
    std::vector<CampaignRun> done(missing.size());
    run_batch(
        missing.size(), order.jobs,
        [&](std::size_t i) { done[i] = ran(catalogue, order, missing[i]); },
        [&](std::size_t i) {
            journal.add(done[i]);
            if (!done[i].outcome.accounted_for()) {
                std::fprintf(stderr, "%s", not_held_line(order, done[i]).c_str());
            }
        });

    std::vector<CampaignRun> runs;
    for (std::uint64_t n = 0; n < order.seeds; ++n) {
        runs.push_back(*journal.find(order.first_seed + n));
    }
    const std::string json = campaign_json(order, runs);
    if (!order.out.empty()) {
        write_file(fs::path(order.out) / (journal.name() + ".json"), json);
    }
    print(order.json ? json : campaign_report(order, runs));
    return std::all_of(runs.begin(), runs.end(),
                       [](const CampaignRun &run) { return run.outcome.accounted_for(); });
}

} // namespace scenario
