/*
 * Runs scenarios in a number format whose every period is computed in double, too (witness.h).
 *
 * usage: one_step LAYOUT FORMAT SCENARIO...    exit 0: every period is explained
 */
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "sil/scenario/catalogue.h"
#include "sil/scenario/number_formats.h"
#include "sil/scenario/record.h"
#include "sil/scenario/runner.h"
#include "sil/scenario/scenario_file.h"
#include "tests/one_step/layout.h"
#include "tests/one_step/witness.h"

namespace
{

/* Of a million periods at most so many decide otherwise. */
constexpr double decided_per_million = 100;

void run(const std::string &name, const firmware_image &image)
{
    const scenario::Scenario scenario =
        scenario::read_scenario(scenario::Catalogue({}, {}), name, {}, name);
    scenario::Record record(scenario::row_period_s(scenario));
    scenario::run(scenario, image, scenario.seed, record);
}

void print(const one_step::Findings &findings)
{
    for (const auto &[name, seen] : findings.blocks) {
        std::printf("block %s: %.1f last places", name.c_str(), seen.places);
        if (!seen.places_of.empty()) {
            std::printf(" (%s)", seen.places_of.c_str());
        }
        if (!seen.angle_of.empty()) {
            std::printf(", %.0f units (%s)", seen.angle, seen.angle_of.c_str());
        }
        std::printf("\n");
    }
    for (const auto &[what, periods] : {std::pair{"decides otherwise", &findings.decided},
                                        std::pair{"NOT EXPLAINED", &findings.unexplained}}) {
        for (const auto &[field, count] : *periods) {
            std::printf("%s: %s, %llu periods\n", what, field.c_str(),
                        static_cast<unsigned long long>(count));
        }
    }
    for (const std::string &one : findings.examples) {
        std::printf("    %s\n", one.c_str());
    }
}

} // namespace

int main(int count, char **arguments)
try {
    if (count < 4) {
        std::fprintf(stderr, "usage: one_step LAYOUT FORMAT SCENARIO...\n");
        return 2;
    }
    const one_step::Layout layout(arguments[1]);
    one_step::Findings findings;
    const firmware_image image =
        one_step::witnessed(*scenario::image_of(arguments[2]), layout, findings);
    try {
        for (int i = 3; i < count; ++i) {
            run(arguments[i], image);
        }
    } catch (const one_step::Unexplained &reason) {
        std::printf("%s\n", reason.what());
    }
    std::printf("%llu periods, %llu decide otherwise, %llu are not explained; %llu draws\n",
                static_cast<unsigned long long>(findings.periods),
                static_cast<unsigned long long>(findings.decided_periods),
                static_cast<unsigned long long>(findings.unexplained_periods),
                static_cast<unsigned long long>(findings.draws));
    print(findings);
    const auto periods = static_cast<double>(findings.periods);
    return findings.unexplained_periods == 0 &&
                   static_cast<double>(findings.decided_periods) * 1e6 <=
                       decided_per_million * periods
               ? 0
               : 1;
} catch (const std::exception &error) {
    std::fprintf(stderr, "one_step: %s\n", error.what());
    return 1;
}
