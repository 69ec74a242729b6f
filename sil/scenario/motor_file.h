/* A motor file: the parameters of one motor in SI units, and where they come from. */
#ifndef STEADYSTEP_SCENARIO_MOTOR_FILE_H
#define STEADYSTEP_SCENARIO_MOTOR_FILE_H

#include <filesystem>
#include <string>

#include "sil/board/board.h"
#include "sil/scenario/document.h"

namespace scenario
{

struct Motor {
    std::string id, description, source;
    motor_params params{};
    Value document; /* where everything was written */
};

/* Throws InputError. */
Motor read_motor(const std::filesystem::path &file);

} // namespace scenario

#endif
