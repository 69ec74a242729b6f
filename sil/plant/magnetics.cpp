#include "sil/plant/magnetics.h"

#include "sil/plant/elementary.h"
#include "sil/plant/require.h"

namespace plant
{

namespace
{

constexpr int most_iterations = 100; /* a dozen do, at the greatest depth */

void require_near_one(double scale, const char *field)
{
    require(scale >= 0.5 && scale <= 2.0, field, scale, "0.5...2");
}

void require_magnet_rise(double rise_K)
{
    require(rise_K >= -100.0 && rise_K <= 200.0, "magnet_rise_K", rise_K, "-100...200 K");
}

/* x of x + b x^3 = current_A: Newton's method from the unsaturated side, where it cannot fail. */
double unsaturate(double current_A, double saturation)
{
    double x = current_A;
    for (int iteration = 0; iteration < most_iterations; iteration++) {
        const double error = x + saturation * x * x * x - current_A;
        const double change = error / (1.0 + 3.0 * saturation * x * x);
        x -= change;
        if (magnitude(change) <= 1e-9 * magnitude(x)) { /* its square is left */
            break;
        }
    }
    return x;
}

/* What is measured at zero current, as shares of L0 and Kx. */
struct Measured {
    double inductance, torque_constant;
};

Measured measured_at_zero_current(const Magnetics &motor)
{
    constexpr int angles = 32; /* of half a turn: both are smooth and periodic */
    double inductance = 0.0;
    double fundamental = 0.0;
    for (int n = 0; n < angles; n++) {
        const Axes axes = axes_of(unit_vector(pi * (n + 0.5) / angles));
        const double axis = motor.magnet_axis(axes.once, axes.thrice)[0];
        const double x = unsaturate(motor.magnet_A * axis, motor.saturation);
        inductance += 1.0 / (1.0 + 3.0 * motor.saturation * x * x) / angles;
        fundamental += 2.0 * x * axes.once[0] / angles;
    }
    return {inductance, fundamental / motor.magnet_A};
}

/* Of both phases alike, at the temperature of the torque constant. */
Magnetics designed(const MotorConfig &motor, const ImperfectionConfig &imperfections)
{
    const double depth = imperfections.saturation_depth;
    const double rated_A = imperfections.rated_current_A;
    Magnetics magnetics;
    const double holding_Nm = holding_torque_Nm(motor, imperfections);
    magnetics.teeth = motor.rotor_teeth;
    magnetics.harmonic = imperfections.flux_harmonic_3;
    magnetics.detent_4 = imperfections.detent_4 * holding_Nm;
    magnetics.detent_2 = imperfections.detent_2 * holding_Nm;
    magnetics.detent_1 = imperfections.detent_1 * holding_Nm;
    magnetics.inductance = motor.inductance_H;
    magnetics.torque = motor.torque_constant_Nm_A;
    magnetics.magnet_A = magnetics.torque / (magnetics.teeth * magnetics.inductance);
    if (depth == 0.0 || magnetics.magnet_A == 0.0) {
        require(depth == 0.0, "torque_constant_Nm_A", motor.torque_constant_Nm_A,
                "above 0 with saturation");
        return magnetics;
    }
    /* 3 b x^2 where magnet and rated current are aligned, x + b x^3 = I_f + I_rated. */
    const double excess = depth / (1.0 - depth);
    for (int iteration = 0; iteration < most_iterations; iteration++) {
        const double aligned = (magnetics.magnet_A * (1.0 + magnetics.harmonic / 3.0) + rated_A) /
                               (1.0 + excess / 3.0);
        magnetics.saturation = excess / (3.0 * aligned * aligned);
        const Measured share = measured_at_zero_current(magnetics);
        const double inductance = motor.inductance_H / share.inductance;
        const double torque = motor.torque_constant_Nm_A / share.torque_constant;
        const double change = magnitude(inductance / magnetics.inductance - 1.0) +
                              magnitude(torque / magnetics.torque - 1.0);
        magnetics.inductance = inductance;
        magnetics.torque = torque;
        magnetics.magnet_A = torque / (magnetics.teeth * inductance);
        if (change < 1e-14) {
            break;
        }
    }
    return magnetics;
}

void require_imperfections(const ImperfectionConfig &imperfections)
{
    const double depth = imperfections.saturation_depth;
    const double rated_A = imperfections.rated_current_A;
    require(rated_A >= 0.0 && rated_A <= 1e4, "rated_current_A", rated_A, "0...1e4 A");
    require(depth >= 0.0 && depth <= 0.5, "saturation_depth", depth, "0...0.5");
    require(magnitude(imperfections.flux_harmonic_3) <= 0.2, "flux_harmonic_3",
            imperfections.flux_harmonic_3, "-0.2...0.2");
    require(magnitude(imperfections.detent_4) <= 1.0, "detent_4", imperfections.detent_4, "-1...1");
    require(magnitude(imperfections.detent_2) <= 1.0, "detent_2", imperfections.detent_2, "-1...1");
    require(magnitude(imperfections.detent_1) <= 1.0, "detent_1", imperfections.detent_1, "-1...1");
    require(rated_A > 0.0 || depth == 0.0, "rated_current_A", rated_A,
            "the current at which the saturation depth is reached");
    require_near_one(imperfections.inductance_a_scale, "inductance_a_scale");
    require_near_one(imperfections.inductance_b_scale, "inductance_b_scale");
    require(imperfections.magnet_flux_per_K >= -0.01 && imperfections.magnet_flux_per_K <= 0.0,
            "magnet_flux_per_K", imperfections.magnet_flux_per_K, "-0.01...0");
    require_magnet_rise(imperfections.magnet_rise_K);
    const double flux = 1.0 + imperfections.magnet_flux_per_K * imperfections.magnet_rise_K;
    require(flux >= 0.1, "magnet_rise_K", imperfections.magnet_rise_K,
            "what leaves the magnet a tenth of its flux");
}

} // namespace

double Magnetics::unmagnetised_detent_4() const
{
    return detent_4 - 4.0 / 3.0 * harmonic * torque * mean_magnet_A();
}

/* sum of I_f m f of the phases = ... - (I_f,a - I_f,b) / 2 (1 + 2 h / 3) sin 2 phi - h^2 ... */
double Magnetics::unmagnetised_detent_2() const
{
    const double difference_A = phase_magnet_A[0] - phase_magnet_A[1];
    return detent_2 - 0.5 * difference_A * torque * (1.0 + 2.0 / 3.0 * harmonic);
}

Phases Magnetics::current_A(Phases flux, const Axes &axes) const
{
    return flux + phase_saturation * (flux * flux * flux) -
           phase_magnet_A * magnet_axis(axes.once, axes.thrice);
}

Phases Magnetics::flux(Phases current_A, const Axes &axes) const
{
    const Phases total = current_A + phase_magnet_A * magnet_axis(axes.once, axes.thrice);
    return Phases{unsaturate(total[0], phase_saturation[0]),
                  unsaturate(total[1], phase_saturation[1])};
}

double Magnetics::torque_Nm(Phases flux, const Axes &axes) const
{
    return torque * dot(flux, magnet_slope(axes.once, axes.thrice)) -
           unmagnetised_detent_4() * axes.four_times[1] - unmagnetised_detent_2() * axes.twice[1] -
           detent_1 * axes.once[1];
}

double Magnetics::energy_J(Phases flux, const Axes &axes) const
{
    const Phases square = flux * flux;
    const Phases axis = magnet_axis(axes.once, axes.thrice);
    const double of_currents =
        0.5 * dot(phase_inductance, square * (1.0 + 0.5 * phase_saturation * square) -
                                        2.0 * phase_magnet_A * flux * axis) +
        0.5 * torque / teeth * mean_magnet_A() * dot(axis, axis);
    return of_currents - (0.25 * detent_4 * axes.four_times[0] +
                          0.5 * unmagnetised_detent_2() * axes.twice[0] + detent_1 * axes.once[0]) /
                             teeth;
}

double holding_torque_Nm(const MotorConfig &motor, const ImperfectionConfig &imperfections)
{
    constexpr double sqrt_2 = 1.41421356237309504880;
    return sqrt_2 * motor.torque_constant_Nm_A * imperfections.rated_current_A;
}

Magnetics magnetics_of(const MotorConfig &motor, const ImperfectionConfig &imperfections)
{
    require_imperfections(imperfections);
    Magnetics magnetics = designed(motor, imperfections);
    const double flux = 1.0 + imperfections.magnet_flux_per_K * imperfections.magnet_rise_K;
    magnetics.magnet_A *= flux;
    magnetics.torque *= flux;
    magnetics.detent_4 *= flux * flux;
    magnetics.detent_2 *= flux * flux;
    magnetics.detent_1 *= flux * flux;
    const Phases scale = {imperfections.inductance_a_scale, imperfections.inductance_b_scale};
    magnetics.phase_inductance = magnetics.inductance * scale;
    magnetics.phase_magnet_A = magnetics.magnet_A / scale;
    magnetics.phase_saturation = magnetics.saturation * (scale * scale * scale);
    return magnetics;
}

} // namespace plant
