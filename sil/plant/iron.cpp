#include "sil/plant/iron.h"

#include "sil/plant/elementary.h"
#include "sil/plant/magnetics.h"
#include "sil/plant/require.h"

namespace plant
{

namespace
{

constexpr double all_of_it = 40.0; /* e^-40 is below rounding */

/* What is left of 1 after x time constants. */
double left_after(double x)
{
    return x < all_of_it ? falling_exponential(-x) : 0.0;
}

} // namespace

Iron iron_of(const MotorConfig &motor, const ImperfectionConfig &imperfections,
             const Magnetics &magnetics, double period_s)
{
    const IronConfig &config = imperfections.iron;
    require(config.hysteresis >= 0.0 && config.hysteresis <= 0.2, "hysteresis", config.hysteresis,
            "0...0.2");
    require(config.hysteresis_flux >= 0.02 && config.hysteresis_flux <= 10.0, "hysteresis_flux",
            config.hysteresis_flux, "0.02...10");
    require(config.eddy_time_s >= 0.0 && config.eddy_time_s <= 1e-4, "eddy_time_s",
            config.eddy_time_s, "0 (none)...1e-4 s");
    require(config.eddy_lag_s >= 0.0 && config.eddy_lag_s <= 1e-2, "eddy_lag_s", config.eddy_lag_s,
            "0...0.01 s");
    Iron iron;
    iron.present = config.hysteresis > 0.0 || config.eddy_time_s > 0.0;
    if (!iron.present) {
        return iron;
    }
    const double magnet_Vs = motor.torque_constant_Nm_A / motor.rotor_teeth;
    require(magnet_Vs > 0.0 && imperfections.rated_current_A > 0.0, "hysteresis", config.hysteresis,
            "with a torque constant and a rated current only");
    iron.coercive_A = config.hysteresis * imperfections.rated_current_A;
    iron.per_flux = 1.0 / (config.hysteresis_flux * magnet_Vs);
    iron.eddy_A_per_Vs = (config.eddy_time_s / period_s) / magnetics.phase_inductance;
    iron.eddy_left = config.eddy_lag_s > 0.0 ? left_after(period_s / config.eddy_lag_s) : 0.0;
    return iron;
}

Phases magnetise(IronState &state, const Iron &iron, Phases change_Vs)
{
    for (int phase = 0; phase < 2; phase++) {
        const double sign = change_Vs[phase] < 0.0 ? -1.0 : 1.0;
        const double left = left_after(magnitude(change_Vs[phase]) * iron.per_flux);
        state.magnetised[phase] = sign + (state.magnetised[phase] - sign) * left;
    }
    const Phases steady_A = iron.eddy_A_per_Vs * change_Vs;
    state.eddy_A = steady_A + iron.eddy_left * (state.eddy_A - steady_A);
    return iron.coercive_A * state.magnetised + state.eddy_A;
}

} // namespace plant
