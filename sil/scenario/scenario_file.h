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

/* What the command line lays over a scenario's files. */
struct CommandLine {
    std::string parameters;            /* of --parameters; "" */
    std::vector<std::string> settings; /* of --set: "table.key=value" */
    bool typed = false;                /* of --typed: commands go to the drive as typed lines */
    std::string image{};               /* of --image: runs on the virtual board; "": on the SIL's */
    std::string settings_file{};       /* of --settings; "" */
};

/* What --set gives, with `plant=real` as `plant.model=real`. */
std::vector<std::string> with_plant_spelled_out(std::vector<std::string> sets);

struct Scenario {
    std::string name, description;
    std::string asked; /* name or path by which it was asked for */
    Motor motor;
    double duration_s = 0;
    std::uint64_t seed = 1;
    std::vector<std::string> numerics{"float", "fixed"}; /* formats it is judged in */
    bool record_enabling = false;
    std::uint32_t record_every = 1; /* periods from one row of the record to the next */
    double settling_band_rad = 2e-3;
    drive_settings drive{};
    plant::Config plant; /* motor: as the plant starts, scales applied */
    PlantScales scales;
    MachineSwitches switches;
    double comparator_trip_A = 0; /* of the simulated board; 0: not fitted */
    std::vector<Event> events;    /* sorted by time */
    std::vector<Expectation> expectations;
    std::vector<Expectation> reports; /* figures without a bound */
    std::string parameters;           /* name of the parameter set in use; "": none */
    CommandLine given;                /* on top of its files */
    Value document;                   /* where everything was written */

    /* The place to complain about a text of drive or board that begins with a field's name. */
    std::string locate(const std::string &complaint) const;
};

plant::MotorConfig scaled(const motor_params &motor, const PlantScales &scales);

/* A tuned law: drive settings to be laid under a scenario's own. */
struct ParameterSet {
    std::string description;
    Value drive; /* its [drive] */
};

/* Throws InputError. */
ParameterSet read_parameters(const std::filesystem::path &file);

/*
 * Reads a scenario by name or path, its bases first. Where a key is given more than once, --set
 * counts, then --settings, then --parameters, then the scenario's own, then the parameter set it
 * names.
 * Throws InputError.
 */
Scenario read_scenario(const Catalogue &catalogue, const std::string &name,
                       const CommandLine &given, const std::string &asked_by);

/* The same of a text without a base; `name` stands for its file. `own_motor`: takes the place of
   the motor it names; nullptr: none. */
Scenario read_scenario_text(const Catalogue &catalogue, const std::string &text,
                            const std::string &name, const CommandLine &given,
                            const Motor *own_motor = nullptr);

} // namespace scenario

#endif
