/*
 * Random numbers of a seed, and the text of a scenario file made of them. From + - * / only, and
 * every number drawn is a short decimal: the same text on every machine.
 */
#ifndef STEADYSTEP_SCENARIO_RANDOM_SCENARIO_H
#define STEADYSTEP_SCENARIO_RANDOM_SCENARIO_H

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace scenario
{

/* Counter mode: number n is a function of (seed, stream, n). */
class Draw
{
  public:
    /* Streams of one seed are independent: what one draws more leaves the others as they are. */
    Draw(std::uint64_t seed, std::uint64_t stream);

    /* Uniform in low...high in whole 1 / parts_per_unit, both ends in. */
    double between(double low, double high, double parts_per_unit);
    /* The same with density falling to the upper end as 1 / sqrt: low + (high - low) u^2. */
    double mostly_low(double low, double high, double parts_per_unit);
    /* Every octave of low...high alike, and even within it; to four significant digits. */
    double over_octaves(double low, double high);
    double either_sign(double magnitude);
    bool chance(double probability);
    std::size_t index(std::size_t count); /* 0...count - 1 */

  private:
    double uniform(); /* [0, 1), 53 bits */

    std::uint64_t key_, next_ = 0;
};

/* Rounded to whole 1 / parts_per_unit, ties up. */
double rounded(double value, double parts_per_unit);

/* To so many significant digits; digits before the point all stay. */
double significant(double value, int digits);

/* value x scale to four significant digits; the value itself where the scale is 1. */
double times(double value, double scale);

class ScenarioText
{
  public:
    void comment(const std::string &text);
    void table(const std::string &name); /* what follows is of [name] */
    void number(const std::string &key, double value);
    void integer(const std::string &key, std::uint64_t value);
    void text(const std::string &key, const std::string &value);
    void flag(const std::string &key, bool value);
    /* One line of `event` or `expect`; `fields` as TOML writes them: `command = "stop"`. */
    void event(double time_s, const std::string &fields);
    void expect(const std::string &fields);

    std::string finish() const;

  private:
    std::string top_, tables_;
    std::vector<std::string> events_, expectations_;
    bool in_table_ = false;
};

} // namespace scenario

#endif
