/*
 * A motor file: the parameters of one motor in SI units, as its data sheet prints them, and where
 * they come from. How to write one: sil/motors/README.md.
 */
#ifndef STEADYSTEP_SCENARIO_MOTOR_FILE_H
#define STEADYSTEP_SCENARIO_MOTOR_FILE_H

#include <filesystem>
#include <optional>
#include <string>

#include "sil/board/board.h"
#include "sil/scenario/document.h"

namespace scenario
{

struct Motor {
    std::string id, description, source;
    std::string stated, assumed; /* what the data sheet prints, what it does not */
    std::string unusual;         /* why its values are unlike those of other motors; "" */
    motor_params params{};       /* inertia: rotor and load together */
    std::optional<double> rotor_inertia_kgm2; /* where the file gives it apart from the load's */
    std::optional<double> detent_torque_Nm;   /* peak */
    Value document;                           /* where everything was written */

    double holding_torque_Nm() const; /* two phases on: sqrt 2 x torque constant x rated current */
};

/* Throws InputError; values that no hybrid stepper has are refused (motor_plausibility.h). */
Motor read_motor(const std::filesystem::path &file);

/* The same of a text; `id` stands for its file. */
Motor read_motor_text(const std::string &text, const std::string &id);

} // namespace scenario

#endif
