/*
 * A scenario: motor, drive settings, plant, a timeline of events, and what must come of it. How to
 * write one: sil/README.md.
 */
#ifndef STEADYSTEP_SCENARIO_SCENARIO_FILE_H
#define STEADYSTEP_SCENARIO_SCENARIO_FILE_H

#include <cstdint>
#include <string>
#include <vector>

#include "sil/board/board.h"
#include "sil/scenario/catalogue.h"
#include "sil/scenario/document.h"
#include "sil/scenario/motor_file.h"
#include "sil/scenario/timeline.h"

namespace scenario
{

struct Scenario {
    std::string name, description;
    std::string asked; /* name or path by which it was asked for */
    Motor motor;
    double duration_s = 0;
    std::uint64_t seed = 1;
    bool record_enabling = false;
    double settling_band_rad = 2e-3;
    drive_settings drive{};
    plant::Config plant; /* motor: as the plant starts, scales applied */
    PlantScales scales;
    std::vector<Event> events; /* sorted by time */
    std::vector<Expectation> expectations;
    std::vector<std::string> settings; /* the --set it was read with */
    Value document;                    /* where everything was written */

    /* The place to complain about a text of drive or board that begins with a field's name. */
    std::string locate(const std::string &complaint) const;
};

plant::MotorConfig scaled(const motor_params &motor, const PlantScales &scales);

/* Reads a scenario by name or path, its bases first, `settings` ("table.key=value") last.
   Throws InputError. */
Scenario read_scenario(const Catalogue &catalogue, const std::string &name,
                       const std::vector<std::string> &settings, const std::string &asked_by);

} // namespace scenario

#endif
