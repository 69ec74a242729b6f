#include "tests/one_step/layout.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace one_step
{

namespace
{

const std::vector<std::string> kinds{"num",   "unit",    "coef",  "real",    "position",
                                     "angle", "integer", "exact", "pointer", "bytes"};

Kind kind_of(const std::string &name)
{
    const auto found = std::find(kinds.begin(), kinds.end(), name);
    if (found == kinds.end()) {
        throw std::runtime_error("no such kind of field: " + name);
    }
    return static_cast<Kind>(found - kinds.begin());
}

Field field_of(std::istream &text)
{
    Field field{};
    std::string kind;
    text >> kind >> field.tested >> field.in_double >> field.bytes >> field.double_bytes >>
        field.condition >> field.path;
    field.kind = kind_of(kind);
    return field;
}

Condition condition_of(std::istream &text)
{
    Condition condition{};
    std::size_t number = 0;
    text >> number >> condition.offset >> condition.bytes;
    for (std::int64_t value = 0; text >> value;) {
        condition.values.push_back(value);
    }
    return condition;
}

} // namespace

Layout::Layout(const std::string &file)
{
    std::ifstream lines(file);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream text(line);
        std::string what;
        text >> what;
        if (what == "size") {
            text >> tested_bytes >> double_bytes;
        } else if (what == "block") {
            Block block{};
            text >> block.tested >> block.tested_bytes >> block.in_double >> block.double_bytes >>
                block.name;
            blocks.push_back(block);
        } else if (what == "condition") {
            conditions.push_back(condition_of(text));
        } else if (what == "target") {
            std::size_t tested = 0;
            text >> tested >> targets[tested];
        } else if (what == "field") {
            fields.push_back(field_of(text));
        }
    }
    if (tested_bytes == 0 || fields.empty()) {
        throw std::runtime_error(file + ": no layout");
    }
    /* Bytes of a union first: what is computed may lie in them. */
    std::stable_partition(fields.begin(), fields.end(),
                          [](const Field &field) { return field.kind == Kind::bytes; });
    for (std::size_t i = 0; i < fields.size(); ++i) {
        Field &field = fields[i];
        for (std::size_t k = 0; k < blocks.size(); ++k) {
            if (field.tested >= blocks[k].tested &&
                field.tested < blocks[k].tested + blocks[k].tested_bytes) {
                field.block = k;
            }
        }
        blocks[field.block].fields.push_back(i);
        const auto rest = std::find_if(fields.begin(), fields.end(), [&](const Field &other) {
            return other.path == field.path + "_remainder";
        });
        field.remainder = rest == fields.end() ? nullptr : &*rest;
    }
}

const Field &Layout::field(const std::string &path) const
{
    const auto found = std::find_if(fields.begin(), fields.end(),
                                    [&](const Field &field) { return field.path == path; });
    if (found == fields.end()) {
        throw std::runtime_error("no such field: " + path);
    }
    return *found;
}

} // namespace one_step
