#include "firmware/numeric/angle.h"

static const double two_pi = 6.283185307179586476925;
static const double angle_per_turn = 4294967296.0;

struct position position_from_rad(double rad, int32_t rotor_teeth)
{
    double turns = rad * (double)rotor_teeth / two_pi;
    struct position p;
    double whole;

    if (!(turns > -2147483647.0)) {
        turns = -2147483647.0;
    } else if (turns > 2147483646.0) {
        turns = 2147483646.0;
    }
    p.turns = (int32_t)turns;
    if ((double)p.turns > turns) {
        p.turns -= 1;
    }
    whole = (double)p.turns;
    /* The fraction may round up to a full turn, which wraps to zero of the next. */
    uint64_t fraction = (uint64_t)((turns - whole) * angle_per_turn + 0.5);
    p.turns += (int32_t)(fraction >> 32);
    p.fraction = (angle_t)fraction;
    return p;
}

double position_to_rad(struct position p, int32_t rotor_teeth)
{
    double turns = (double)p.turns + (double)p.fraction / angle_per_turn;

    return turns * two_pi / (double)rotor_teeth;
}
