/* What the events of a timeline do to a board and its plant, one control period at a time. */
#ifndef STEADYSTEP_SCENARIO_PLANT_EVENTS_H
#define STEADYSTEP_SCENARIO_PLANT_EVENTS_H

#include <cstdint>
#include <vector>

#include "sil/board/drive_board.h"
#include "sil/scenario/scenario_file.h"

namespace scenario
{

/* All that can drift, as the scenario begins. */
PlantValues plant_values_of(const Scenario &scenario);

/* Hands one part of the plant its values; throws std::invalid_argument. */
void put_plant_part(const Scenario &scenario, const PlantValues &values, PlantPart part,
                    plant::Plant &plant);

class PlantEvents
{
  public:
    PlantEvents(const Scenario &scenario, sil::DriveBoard &board);

    /* In period n: load, fault, short circuit, stall, or drifts, which begin. */
    void act(const Event &event, std::uint32_t n);
    /* In each period, behind act(): what drifts goes on, and so do the machine's switches. */
    void go_on(std::uint32_t n);

    const plant::MotorConfig &motor() const
    {
        return motor_;
    }

  private:
    /* A drift on its way. */
    struct Course {
        Drift drift;
        double from;
        std::uint32_t start, periods;
    };

    void drift(std::uint32_t n);
    void put_switches();

    const Scenario &scenario_;
    sil::DriveBoard &board_;
    std::uint32_t inputs_ = HAL_INPUTS; /* levels, but for switches that the machine works */
    PlantValues values_;
    plant::MotorConfig motor_;
    std::vector<Course> courses_;
};

} // namespace scenario

#endif
