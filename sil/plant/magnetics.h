/*
 * The magnetic circuit of a saturable hybrid stepper with a third flux harmonic, one per phase, and
 * its detent torque. With the flux linkage lambda of a phase, the magnet's included, and
 * phi = N theta:
 *
 *   i      = lambda / L0 + beta lambda^3 - I_f m(phi)
 *   m_a    = cos phi + h/3 cos 3 phi     f_a = dm_a/dphi = -sin phi - h sin 3 phi
 *   m_b    = sin phi - h/3 sin 3 phi     f_b = dm_b/dphi =  cos phi - h cos 3 phi
 *   W      = sum of lambda^2 / (2 L0) + beta lambda^4 / 4 - I_f lambda m
 *            + L0 I_f^2 / 2 |m|^2 - Td4/(4N) cos 4 phi - Td2/(2N) cos 2 phi - Td1/N cos phi
 *   i      = dW/dlambda                  torque = -dW/dtheta at constant lambda:
 *   torque = N I_f (lambda - L0 I_f m) . f - Td4 sin 4 phi - Td2 sin 2 phi - Td1 sin phi
 *
 * so that electrical power = copper loss + dW/dt + torque x speed, whatever the parameters. The
 * term |m|^2 makes Td4 the whole detent torque of an unsaturated motor: without it the flux
 * harmonic would add its own, -(4/3) h N L0 I_f^2 sin 4 phi. Saturation adds
 * N beta (L0 I_f)^4 / 4 sin 4 phi, some 1.5 mN m at 10 % depth of bendjedia-2012.
 *
 * Here in the unknown x = lambda / L0, A, and b = beta L0^3:
 *
 *   i = x + b x^3 - I_f m                torque = Kx x . f - D4 sin 4 phi - Td2 ... - Td1 ...
 *
 * Kx = N L0 I_f, D4 = Td4 - (4/3) h Kx I_f.
 *
 * A phase whose L0 is s times that has the same flux of the magnet, so that its I_f is 1/s of it,
 * and the same beta: its b is s^3 of it. |m|^2 has the mean I_f; what a phase's own then adds to
 * the detent torque, two periods a tooth, is taken off Td2, but for h^2.
 * A warm magnet has less I_f, and the detent goes with its square.
 */
#ifndef STEADYSTEP_PLANT_MAGNETICS_H
#define STEADYSTEP_PLANT_MAGNETICS_H

#include "sil/plant/phases.h"
#include "sil/plant/plant.h"

namespace plant
{

/* (cos, sin) of phi, 2 phi, 3 phi and 4 phi. */
struct Axes {
    Phases once, twice, thrice, four_times;
};

inline Axes axes_of(Phases once)
{
    const auto product = [](Phases x, Phases y) { /* of complex numbers */
                                                  return x[0] * y + x[1] * quarter_turn(y);
    };
    const Phases twice = product(once, once);
    return {once, twice, product(once, twice), product(twice, twice)};
}

struct Magnetics {
    double inductance = 0.0;                               /* L0, H: unsaturated */
    double magnet_A = 0.0;                                 /* I_f */
    double saturation = 0.0;                               /* b, 1/A^2 */
    double harmonic = 0.0;                                 /* h */
    double torque = 0.0;                                   /* Kx, N m/A */
    double detent_4 = 0.0, detent_2 = 0.0, detent_1 = 0.0; /* Td, N m */
    double teeth = 0.0;                                    /* N */

    /* Of each phase: L0, I_f and b. */
    Phases phase_inductance = {0.0, 0.0}, phase_magnet_A = {0.0, 0.0};
    Phases phase_saturation = {0.0, 0.0};

    /* m and f of the axes. */
    Phases magnet_axis(Phases once, Phases thrice) const
    {
        return once + (harmonic * (1.0 / 3.0)) * (thrice * Phases{1.0, -1.0});
    }
    Phases magnet_slope(Phases once, Phases thrice) const
    {
        return quarter_turn(once) - harmonic * exchanged(thrice);
    }
    double mean_magnet_A() const
    {
        return 0.5 * (phase_magnet_A[0] + phase_magnet_A[1]);
    }
    double unmagnetised_detent_4() const; /* D4 */
    double unmagnetised_detent_2() const; /* of phases that differ */

    Phases current_A(Phases flux, const Axes &axes) const;
    Phases flux(Phases current_A, const Axes &axes) const; /* x of a current: its inverse */
    double torque_Nm(Phases flux, const Axes &axes) const;
    double energy_J(Phases flux, const Axes &axes) const; /* W */
};

/*
 * From what is measured at zero current: inductance_H is the mean over the rotor angle of the
 * incremental inductance, torque_constant_Nm_A that of the fundamental of the open-circuit voltage.
 * Throws std::invalid_argument.
 */
Magnetics magnetics_of(const MotorConfig &motor, const ImperfectionConfig &imperfections);

/* sqrt 2 x torque constant x rated current, N m. */
double holding_torque_Nm(const MotorConfig &motor, const ImperfectionConfig &imperfections);

} // namespace plant

#endif
