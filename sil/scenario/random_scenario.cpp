#include "sil/scenario/random_scenario.h"

#include <cmath>

#include "sil/scenario/text.h"

namespace scenario
{

namespace
{

constexpr std::uint64_t golden = 0x9e3779b97f4a7c15U; /* 2^64 over the golden ratio, odd */

/* A bijection of 64 bits that scatters neighbours: a product carries every bit upwards, the fold
   brings the high half back down. */
std::uint64_t scatter(std::uint64_t x)
{
    for (int round = 0; round < 3; round++) {
        x = (x ^ (x >> 32)) * golden;
    }
    return x ^ (x >> 32);
}

/* Of the line `key = value`. */
std::string line(const std::string &key, const std::string &value)
{
    return key + " = " + value + "\n";
}

std::string array(const std::string &name, const std::vector<std::string> &items)
{
    std::string text = items.empty() ? "" : "\n" + name + " = [\n";
    for (const std::string &item : items) {
        text += "  { " + item + " },\n";
    }
    return text + (items.empty() ? "" : "]\n");
}

} // namespace

Draw::Draw(std::uint64_t seed, std::uint64_t stream)
    : key_(scatter(scatter(seed + golden) + stream))
{
}

double Draw::uniform()
{
    return static_cast<double>(scatter(key_ + ++next_) >> 11) * (1.0 / 9007199254740992.0);
}

double Draw::between(double low, double high, double parts_per_unit)
{
    const double first = std::floor(low * parts_per_unit + 0.5);
    const double last = std::floor(high * parts_per_unit + 0.5);
    return (first + std::floor((last - first + 1) * uniform())) / parts_per_unit;
}

double Draw::mostly_low(double low, double high, double parts_per_unit)
{
    const double u = uniform();
    return rounded(low + (high - low) * u * u, parts_per_unit);
}

double Draw::over_octaves(double low, double high)
{
    double octaves = 0, top = low;
    for (; 2 * top <= high; top *= 2) {
        octaves += 1;
    }
    double place = (octaves + high / top - 1) * uniform();
    double value = low;
    for (; place >= 1; place -= 1) {
        value *= 2;
    }
    return significant(value * (1 + place), 4);
}

double Draw::either_sign(double magnitude)
{
    return chance(0.5) ? magnitude : -magnitude;
}

bool Draw::chance(double probability)
{
    return uniform() < probability;
}

std::size_t Draw::index(std::size_t count)
{
    return static_cast<std::size_t>(static_cast<double>(count) * uniform());
}

double rounded(double value, double parts_per_unit)
{
    return std::floor(value * parts_per_unit + 0.5) / parts_per_unit;
}

double significant(double value, int digits)
{
    double least = 1; /* of the numbers with so many digits before the point */
    for (int i = 1; i < digits; ++i) {
        least *= 10;
    }
    double parts_per_unit = 1;
    while (value != 0 && std::fabs(value) * parts_per_unit < least) {
        parts_per_unit *= 10;
    }
    return rounded(value, parts_per_unit);
}

double times(double value, double scale)
{
    return scale == 1 ? value : significant(value * scale, 4);
}

void ScenarioText::comment(const std::string &text)
{
    (in_table_ ? tables_ : top_) += "# " + text + "\n";
}

void ScenarioText::table(const std::string &name)
{
    tables_ += "\n[" + name + "]\n";
    in_table_ = true;
}

void ScenarioText::number(const std::string &key, double value)
{
    (in_table_ ? tables_ : top_) += line(key, shortest(value));
}

void ScenarioText::integer(const std::string &key, std::uint64_t value)
{
    (in_table_ ? tables_ : top_) += line(key, std::to_string(value));
}

void ScenarioText::text(const std::string &key, const std::string &value)
{
    (in_table_ ? tables_ : top_) += line(key, "\"" + value + "\"");
}

void ScenarioText::flag(const std::string &key, bool value)
{
    (in_table_ ? tables_ : top_) += line(key, value ? "true" : "false");
}

void ScenarioText::event(double time_s, const std::string &fields)
{
    events_.push_back("time_s = " + shortest(time_s) + ", " + fields);
}

void ScenarioText::expect(const std::string &fields)
{
    expectations_.push_back(fields);
}

std::string ScenarioText::finish() const
{
    return top_ + array("event", events_) + array("expect", expectations_) + tables_;
}

} // namespace scenario
