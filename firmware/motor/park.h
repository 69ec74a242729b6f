/* Phase and rotor frames of a two-phase machine; see the sign conventions of motor_params.h. */
#ifndef STEADYSTEP_PARK_H
#define STEADYSTEP_PARK_H

#include "firmware/numeric/trig.h"

struct phases {
    num_t a;
    num_t b;
};

struct dq {
    num_t d; /* along the magnet's flux */
    num_t q; /* a quarter electrical turn ahead: torque is Km i_q */
};

/* What is measured of the winding at S(k). */
struct channels {
    struct phases current;
    struct phases voltage; /* mean over the past period */
};

/* A control frame over the period in which a voltage acts. It carries its own speed: the frame of a
   held rotor stands still, whatever the rotor does in it. */
struct frame {
    struct sincos begin;  /* at the beginning of the period */
    struct sincos middle; /* in its middle, where the voltage is turned back to the phases */
    num_t speed;          /* mechanical, as the rotor's */
};

static inline struct frame frame_at_rest(struct sincos axes)
{
    const struct frame frame = {axes, axes, NUM(0.0)};

    return frame;
}

static inline struct dq park(struct phases x, struct sincos angle)
{
    struct dq y = {num_mul_unit(x.a, angle.cos) + num_mul_unit(x.b, angle.sin),
                   num_mul_unit(x.b, angle.cos) - num_mul_unit(x.a, angle.sin)};
    return y;
}

static inline struct phases inverse_park(struct dq x, struct sincos angle)
{
    struct phases y = {num_mul_unit(x.d, angle.cos) - num_mul_unit(x.q, angle.sin),
                       num_mul_unit(x.d, angle.sin) + num_mul_unit(x.q, angle.cos)};
    return y;
}

#endif
