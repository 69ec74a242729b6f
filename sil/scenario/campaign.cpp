#include "sil/scenario/campaign.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "sil/scenario/batch.h"
#include "sil/scenario/campaign_journal.h"
#include "sil/scenario/campaign_report.h"
#include "sil/scenario/output.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

CampaignRun ran(const Catalogue &catalogue, const CampaignOrder &order, std::uint64_t seed)
{
    const Scenario scenario = drawn_scenario(catalogue, order, seed);
    Record record(1);
    const Result result = execute(scenario, *image_of(order.numeric), scenario.seed, record);
    CampaignRun run;
    run.seed = seed;
    run.outcome = order.kind->judge(result, record);
    run.failure = result.failure;
    run.trace_hash = result.trace_hash;
    run.drive_hash = result.drive_hash;
    run.simulated_s = result.simulated_s;
    return run;
}

} // namespace

const std::vector<const CampaignKind *> &campaign_kinds()
{
    static const std::vector<const CampaignKind *> kinds = {
        &long_run_campaign,
        &slip_campaign,
    };
    return kinds;
}

Scenario drawn_scenario(const Catalogue &catalogue, const CampaignOrder &order, std::uint64_t seed)
{
    const std::string name = std::string(order.kind->name) + "-" + std::to_string(seed);
    return read_scenario_text(catalogue, order.kind->draw(seed, order.duration_s), name,
                              order.given);
}

bool run_campaign(const Catalogue &catalogue, const CampaignOrder &order)
{
    check(drawn_scenario(catalogue, order, order.first_seed), *image_of(order.numeric));
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
            if (!done[i].outcome.held()) {
                std::fprintf(stderr, "%s", not_held_line(order, done[i]).c_str());
            }
        });

    std::vector<CampaignRun> runs;
    for (std::uint64_t n = 0; n < order.seeds; ++n) {
        runs.push_back(*journal.find(order.first_seed + n));
    }
    const std::string json = campaign_json(order, runs);
    if (!order.out.empty()) {
        write_file(std::filesystem::path(order.out) / (journal.name() + ".json"), json);
    }
    std::fputs(order.json ? json.c_str() : campaign_report(order, runs).c_str(), stdout);
    return std::all_of(runs.begin(), runs.end(),
                       [](const CampaignRun &run) { return run.outcome.held(); });
}

} // namespace scenario
