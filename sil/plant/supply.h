/*
 * The bus behind a source that cannot take current back, with a capacitor and a brake resistor:
 *
 *   C dV/dt = max((Vs - V) / Rs, 0) - V / Rb [brake on] - current into the bridges
 *
 * The brake is connected at brake_V and off again below 98 % of it, or as the drive wants it in
 * each period.
 */
#ifndef STEADYSTEP_PLANT_SUPPLY_H
#define STEADYSTEP_PLANT_SUPPLY_H

#include "sil/plant/plant.h"

namespace plant
{

struct Supply {
    double source_V = 0.0;
    double source_rate = 0.0;     /* 1 / (Rs C), 1/s */
    double brake_rate = 0.0;      /* 1 / (Rb C), 1/s */
    double per_capacitance = 0.0; /* 1 / C; 0: a stiff bus */
    double capacitance_F = 0.0;
    bool brake_by_drive = false;
    double brake_on_V = 0.0, brake_off_V = 0.0; /* by the drive: never reached */

    bool stiff() const
    {
        return per_capacitance == 0.0;
    }
};

/* Throws std::invalid_argument. */
Supply supply_of(const SupplyConfig &config, double source_V);

} // namespace plant

#endif
