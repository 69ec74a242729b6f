/*
 * A quantity of the two phases (a, b), which is also a vector in the stationary frame. The two
 * lanes share one register; every operation is plain IEEE arithmetic lane by lane.
 */
#ifndef STEADYSTEP_PLANT_PHASES_H
#define STEADYSTEP_PLANT_PHASES_H

namespace plant
{

typedef double Phases __attribute__((vector_size(16)));

inline Phases in_both_lanes(double x)
{
    return Phases{x, x};
}

inline double dot(Phases x, Phases y)
{
    const Phases product = x * y;
    return product[0] + product[1];
}

/* x turned by a quarter turn: from the d axis to the q axis. */
inline Phases quarter_turn(Phases x)
{
    return __builtin_shufflevector(-x, x, 1, 2);
}

/* (b, a) */
inline Phases exchanged(Phases x)
{
    return __builtin_shufflevector(x, x, 1, 0);
}

/* a + b, twice */
inline Phases sum_in_both_lanes(Phases x)
{
    return x + exchanged(x);
}

inline double magnitude(double x)
{
    return x < 0.0 ? -x : x;
}

} // namespace plant

#endif
