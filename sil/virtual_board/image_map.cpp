#include "sil/virtual_board/image_map.h"

#include <cstdio>
#include <fstream>
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

/* One run of instructions, one behind the other. */
void read_run(const Json &run, const std::vector<InstructionCost> &kinds, ImageMap &map)
{
    const Json &stages = run.at("stages");
    std::uint32_t address = run.at("address");
    std::size_t stage = 0, left = 0;
    for (const std::size_t kind : run.at("costs")) {
        while (left == 0) {
            left = stages.at(stage++).at(1);
        }
        --left;
        if (kind >= kinds.size()) {
            throw std::invalid_argument("names a kind of instruction that it does not describe");
        }
        InstructionCost cost = kinds[kind];
        const std::size_t named = stages.at(stage - 1).at(0);
        cost.stage = named < map.stages.size() ? static_cast<std::uint8_t>(named) : inherited_stage;
        map.code.push_back({address, cost});
        address += cost.bytes;
    }
}

ImageMap parse(const Json &json, const ElfImage &image)
{
    if (json.at("format") != 1) {
        throw std::invalid_argument("is of another format than 1");
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
    for (const auto &[name, place] : json.at("signals").items()) {
        map.signals[name] = {place.at(0), place.at(1), place.at(2)};
    }
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
        ImageMap map = parse(Json::parse(stream), image);
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
    map.tell(costs);
    return map;
}

void ImageMap::tell(InstructionCosts &costs) const
{
    costs.stand_in = false;
    costs.rules = rules;
    costs.stages = stages;
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
