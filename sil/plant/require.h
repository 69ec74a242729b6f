/* Refuses a configuration: names the field, its value and what it may be. */
#ifndef STEADYSTEP_PLANT_REQUIRE_H
#define STEADYSTEP_PLANT_REQUIRE_H

#include <sstream>
#include <stdexcept>

namespace plant
{

inline void require(bool holds, const char *field, double value, const char *allowed)
{
    if (!holds) {
        std::ostringstream text;
        text << field << " = " << value << ": expected " << allowed;
        throw std::invalid_argument(text.str());
    }
}

} // namespace plant

#endif
