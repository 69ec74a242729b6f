/* The values of a drive and where they lie in the image that is tested and in that in double: what
   fields.py writes. */
#ifndef STEADYSTEP_ONE_STEP_LAYOUT_H
#define STEADYSTEP_ONE_STEP_LAYOUT_H

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace one_step
{

enum class Kind { num, unit, coef, real, position, angle, integer, exact, pointer, bytes };

struct Field {
    Kind kind;
    std::size_t tested, in_double, bytes, double_bytes; /* offsets and sizes in both images */
    int condition;                                      /* -1: always in use */
    std::string path;
    std::size_t block = 0;
    const Field *remainder = nullptr; /* of a gain: what its 16 bits leave over */
};

struct Block {
    std::size_t tested, tested_bytes, in_double, double_bytes;
    std::string name;
    std::vector<std::size_t> fields;
};

struct Condition {
    std::size_t offset, bytes;
    std::vector<std::int64_t> values;
};

struct Layout {
    explicit Layout(const std::string &file);
    const Field &field(const std::string &path) const;

    std::size_t tested_bytes = 0, double_bytes = 0;
    std::vector<Field> fields;
    std::vector<Block> blocks;
    std::vector<Condition> conditions;
    std::map<std::size_t, std::size_t> targets; /* of pointers: offset, offset in double */
};

} // namespace one_step

#endif
