#include "firmware/numeric/arctangent.h"

/*
 * CORDIC: the vector is turned towards the x axis by the angles arctan 2^-k, each one shift and
 * addition per component, and the angles it has taken are summed up. Its length grows by
 * 1.647 in all, and by sqrt 2 at most from one component to the length: 24 fractional bits of 32
 * leave room for both.
 */
#define TURN(x)  ((uint32_t)((x)*4294967296.0 + 0.5))
#define FRACTION 24

/* arctan(2^-k) / (2 pi) */
static const uint32_t steps[] = {
    TURN(0.125),
    TURN(0.073791808825216632),
    TURN(0.038989565188684662),
    TURN(0.019791712080282773),
    TURN(0.0099342621527704206),
    TURN(0.0049719739117946374),
    TURN(0.0024865936394752068),
    TURN(0.0012433726968348697),
    TURN(0.00062169583435705026),
    TURN(0.00031084910296168581),
    TURN(0.00015542469970501019),
    TURN(7.7712368380565775e-05),
    TURN(3.8856186506291709e-05),
    TURN(1.9428093542646998e-05),
    TURN(9.7140468075111418e-06),
    TURN(4.8570234082790267e-06),
    TURN(2.4285117047049451e-06),
    TURN(1.2142558524231515e-06),
    TURN(6.0712792622041063e-07),
    TURN(3.0356396311130969e-07),
};

static int32_t whole(num_t a)
{
#if STEADYSTEP_NUM == NUM_FIXED
    return a >> (NUM_FRACTION_BITS - FRACTION);
#else
    return num_to_int32(a * NUM(16777216.0));
#endif
}

angle_t angle_of_vector(num_t x_component, num_t y_component)
{
    int32_t x = whole(x_component);
    int32_t y = whole(y_component);
    angle_t angle = 0;

    if (x == 0 && y == 0) {
        return 0;
    }
    if (x < 0) { /* half a turn, so that the rest is within a quarter */
        x = -x;
        y = -y;
        angle = 1u << 31;
    }
    for (unsigned k = 0; k < sizeof steps / sizeof steps[0]; k++) {
        const int32_t across = y >> k;
        const int32_t along = x >> k;

        if (y > 0) {
            x += across;
            y -= along;
            angle += steps[k];
        } else {
            x -= across;
            y += along;
            angle -= steps[k];
        }
    }
    return angle;
}
