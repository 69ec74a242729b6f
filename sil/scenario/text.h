/* Text of numbers and messages, the same on every machine. */
#ifndef STEADYSTEP_SCENARIO_TEXT_H
#define STEADYSTEP_SCENARIO_TEXT_H

#include <cstdint>
#include <string>

namespace scenario
{

/* printf into a string. */
[[gnu::format(printf, 1, 2)]] std::string format(const char *pattern, ...);

/* Shortest digits that read back as the same number. */
std::string shortest(double number);

/* For people: no more than 10 digits, no exponent where none is needed. */
std::string readable(double number);

/* With '?' for line feeds and the like, which names and texts of the user's may hold. */
std::string in_one_line(std::string text);

/* 16 hexadecimal digits. */
std::string hexadecimal(std::uint64_t bits);

} // namespace scenario

#endif
