#include "sil/virtual_board/image_map.h"

#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <nlohmann/json.hpp>

namespace virtual_board
{

namespace
{

using Json = nlohmann::json;

std::uint64_t fnv1a(std::uint64_t hash, std::uint8_t byte)
{
    return (hash ^ byte) * 0x100000001b3u;
}

/* Over what the image loads: address and length of each segment, then its bytes. */
std::string identity_of(const ElfImage &image)
{
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const Segment &segment : image.segments()) {
        const auto length = static_cast<std::uint32_t>(segment.bytes.size());
        for (const std::uint32_t word : {segment.address, length}) {
            for (unsigned i = 0; i < 4; ++i) {
                hash = fnv1a(hash, static_cast<std::uint8_t>(word >> (8 * i)));
            }
        }
        for (const std::uint8_t byte : segment.bytes) {
            hash = fnv1a(hash, byte);
        }
    }
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

Cycles columns(const Json &json)
{
    return {json.at(0), json.at(1), json.at(2)};
}

CostRules rules_of(const Json &json)
{
    CostRules rules;
    rules.refill = columns(json.at("refill"));
    rules.peripheral = columns(json.at("peripheral"));
    rules.enter = columns(json.at("exception").at("enter"));
    rules.leave = columns(json.at("exception").at("leave"));
    rules.floating_point_frame = columns(json.at("exception").at("fpu"));
    rules.flash_wait = json.at("flash").at("wait");
    const unsigned line = json.at("flash").at("line_bytes");
    if (line == 0 || line > 4096) {
        throw std::invalid_argument("flash: line_bytes: expected 1...4096");
    }
    rules.flash_line_shift = 0;
    while (1u << rules.flash_line_shift < line) {
        ++rules.flash_line_shift;
    }
    return rules;
}

/* What instructions of a kind cost; their stage depends on the place. */
InstructionCost kind_of(const Json &row)
{
    InstructionCost cost;
    cost.bytes = row.at(0);
    cost.nominal_after = row.at(1);
    cost.nominal = row.at(2);
    cost.worst_after = row.at(3);
    cost.worst = row.at(4);
    cost.literals = row.at(5);
    return cost;
}

std::size_t digit(char c)
{
    if (c >= '0' && c <= '9') {
        return static_cast<std::size_t>(c - '0');
    }
    if (c >= 'a' && c <= 'f') {
        return static_cast<std::size_t>(c - 'a' + 10);
    }
    throw std::invalid_argument("costs of a run of code: expected hexadecimal digits");
}

/* One run of instructions, one behind the other: two digits each, and how many are of a stage. */
void read_run(const Json &run, const std::vector<InstructionCost> &kinds, ImageMap &map)
{
    const std::string &costs = run.at("costs").get_ref<const std::string &>();
    std::uint32_t address = run.at("address");
    std::size_t at = 0;
    for (const Json &stage : run.at("stages")) {
        const std::size_t named = stage.at(0), instructions = stage.at(1);
        if (instructions > (costs.size() - at) / 2) {
            throw std::invalid_argument("names stages of instructions that it does not describe");
        }
        for (const std::size_t end = at + 2 * instructions; at < end; at += 2) {
            const std::size_t kind = 16 * digit(costs[at]) + digit(costs[at + 1]);
            if (kind >= kinds.size()) {
                throw std::invalid_argument(
                    "names a kind of instruction that it does not describe");
            }
            InstructionCost cost = kinds[kind];
            cost.stage =
                named < map.stages.size() ? static_cast<std::uint8_t>(named) : inherited_stage;
            map.code.push_back({address, cost});
            address += cost.bytes;
        }
    }
    if (at != costs.size()) {
        throw std::invalid_argument("names no stage of some instructions");
    }
}

ImageMap parse(const Json &json, const ElfImage &image)
{
    if (json.at("format") != 4) {
        throw std::invalid_argument("is of another format than 4; tools/image_map writes it");
    }
    if (json.at("identity").at("fnv1a") != identity_of(image)) {
        throw std::invalid_argument("is the map of another image; build both anew");
    }
    ImageMap map;
    map.rules = rules_of(json);
    map.stages = json.at("stages").get<std::vector<std::string>>();
    std::vector<InstructionCost> kinds;
    for (const Json &row : json.at("costs")) {
        kinds.push_back(kind_of(row));
    }
    for (const Json &run : json.at("code")) {
        read_run(run, kinds, map);
    }
    map.core = json.at("core");
    map.numeric = json.at("numeric");
    map.half_period_counts = json.at("half_period_counts");
    for (const auto &[name, place] : json.at("signals").items()) {
        map.signals[name] = {place.at(0), place.at(1), place.at(2)};
    }
    map.enabling = json.at("enabling").get<std::vector<std::uint32_t>>();
    for (const Json &interrupt : json.at("interrupts")) {
        map.interrupts[interrupt.at(0)] = interrupt.at(1);
    }
    return map;
}

} // namespace

ImageMap ImageMap::read(const std::string &file, const ElfImage &image)
{
    std::ifstream stream(file);
    if (!stream) {
        throw std::invalid_argument(file + ": cannot be read; tools/image_map writes it");
    }
    try {
        std::ostringstream text;
        text << stream.rdbuf();
        ImageMap map = parse(Json::parse(text.str()), image);
        map.file = file;
        return map;
    } catch (const Json::exception &error) {
        throw std::invalid_argument(file + ": " + error.what());
    } catch (const std::invalid_argument &error) {
        throw std::invalid_argument(file + ": " + error.what());
    }
}

ImageMap ImageMap::read(const std::string &file, const ElfImage &image, InstructionCosts &costs)
{
    ImageMap map = read(file, image);
    map.give(costs);
    return map;
}

void ImageMap::give(InstructionCosts &costs) const
{
    costs.stand_in = false;
    costs.rules = rules;
    costs.stages = stages;
    costs.enabling = enabling;
    for (const Instruction &instruction : code) {
        InstructionCost *const entry = costs.find(instruction.address);
        if (entry == nullptr) {
            throw std::invalid_argument(file + ": names code where the chip has no memory");
        }
        *entry = instruction.cost;
    }
}

const Variable &ImageMap::signal(const std::string &name) const
{
    const auto found = signals.find(name);
    if (found == signals.end()) {
        throw std::invalid_argument("the image's map names no signal " + name);
    }
    return found->second;
}

std::string map_file_of(const std::string &image_file)
{
    const std::size_t dot = image_file.rfind(".elf");
    const bool ends = dot != std::string::npos && dot + 4 == image_file.size();
    return (ends ? image_file.substr(0, dot) : image_file) + ".map.json";
}

} // namespace virtual_board
