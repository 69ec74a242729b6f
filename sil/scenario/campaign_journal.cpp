#include "sil/scenario/campaign_journal.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "sil/scenario/output.h"
#include "sil/scenario/text.h"

namespace scenario
{

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace
{

/* FNV-1a over words of eight bytes: a program has millions of them. */
std::uint64_t hash_of(const std::string &bytes)
{
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (std::size_t at = 0; at < bytes.size(); at += sizeof(std::uint64_t)) {
        std::uint64_t word = 0;
        std::memcpy(&word, bytes.data() + at, std::min(sizeof word, bytes.size() - at));
        hash = (hash ^ word) * 0x100000001b3u;
        hash ^= hash >> 32; /* a product carries no bit downwards */
    }
    return hash;
}

std::string content_of(const fs::path &file)
{
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream content;
    content << stream.rdbuf();
    return content.str();
}

/* All that was written, in one line. */
std::string text_of(const Value &value)
{
    switch (value.kind) {
    case Value::Kind::boolean:
        return value.boolean ? "true" : "false";
    case Value::Kind::integer:
        return std::to_string(value.integer);
    case Value::Kind::number:
        return shortest(value.number);
    case Value::Kind::text:
        return "\"" + value.text + "\"";
    default:
        break;
    }
    std::string text = "{";
    for (std::size_t i = 0; i < value.items.size(); ++i) {
        text += (i < value.keys.size() ? value.keys[i] + "=" : "") + text_of(value.items[i]) + ",";
    }
    return text + "}";
}

/* All that a result depends on besides the seed. The program's own bytes stand for its version; one
   seed's scenario for duration, settings and parameter set. */
std::string condition_of(const Scenario &seed_0)
{
    return hexadecimal(hash_of(content_of("/proc/self/exe") + text_of(seed_0.document) +
                               text_of(seed_0.motor.document)));
}

double number(const Json &value)
{
    return value.is_number() ? value.get<double>() : Metrics::none;
}

std::uint64_t bits(const Json &value)
{
    return std::stoull(value.get<std::string>(), nullptr, 16);
}

} // namespace

CampaignJournal::CampaignJournal(const Catalogue &catalogue, const CampaignOrder &order)
    : order_(order)
{
    if (order.out.empty()) {
        return;
    }
    prepare_folder(order.out);
    condition_ = condition_of(drawn_scenario(catalogue, order, 0));
    std::ifstream stream(file());
    std::string line;
    while (std::getline(stream, line)) {
        cut_off_ = stream.eof(); /* the last line, without its end */
        const Json json = Json::parse(line, nullptr, false);
        if (json.is_discarded() || json.value("condition", "") != condition_) {
            continue;
        }
        CampaignRun run;
        run.seed = json.at("seed");
        run.outcome.verdict = json.at("verdict");
        for (const CampaignFigure &figure : order.kind->figures) {
            run.outcome.figures.push_back(number(json.at("figures").at(figure.name)));
        }
        run.failure = json.at("failure");
        run.trace_hash = bits(json.at("trace_hash"));
        run.drive_hash = bits(json.at("drive_hash"));
        run.simulated_s = json.at("simulated_s");
        runs_[run.seed] = run;
    }
}

const CampaignRun *CampaignJournal::find(std::uint64_t seed) const
{
    const auto found = runs_.find(seed);
    return found == runs_.end() ? nullptr : &found->second;
}

void CampaignJournal::add(const CampaignRun &run)
{
    runs_[run.seed] = run;
    if (order_.out.empty()) {
        return;
    }
    Json json;
    json["condition"] = condition_;
    json["seed"] = run.seed;
    json["verdict"] = run.outcome.verdict;
    for (std::size_t i = 0; i < order_.kind->figures.size(); ++i) {
        json["figures"][order_.kind->figures[i].name] = run.outcome.figures[i];
    }
    json["failure"] = run.failure;
    json["trace_hash"] = hexadecimal(run.trace_hash);
    json["drive_hash"] = hexadecimal(run.drive_hash);
    json["simulated_s"] = run.simulated_s;
    std::ofstream stream(file(), std::ios::app);
    stream << (cut_off_ ? "\n" : "") << json.dump() << "\n" << std::flush;
    cut_off_ = false;
    if (!stream) {
        throw InputError(file() + ": cannot be written");
    }
}

std::string CampaignJournal::name() const
{
    return std::string(order_.kind->name) + "-" + order_.numeric;
}

std::string CampaignJournal::file() const
{
    return (fs::path(order_.out) / (name() + ".jsonl")).string();
}

} // namespace scenario
