/* What every estimator knows of the motor at S(k), from the samples up to and including S(k). */
#ifndef STEADYSTEP_ESTIMATE_H
#define STEADYSTEP_ESTIMATE_H

#include "firmware/motor/motor_model.h"

struct estimate {
    struct phases current;
    struct rotor rotor;
    struct winding winding;
    struct sincos mid_period; /* at the electrical angle of the middle of S(k)...S(k+1) */
};

/* At rest at a known position, no current and no load. */
static inline void estimate_reset(struct estimate *x, const struct motor_model_params *model,
                                  struct position position, num_t resistance)
{
    const struct phases no_current = {NUM(0.0), NUM(0.0)};

    x->current = no_current;
    x->rotor.position = position;
    x->rotor.speed = NUM(0.0);
    x->rotor.load_torque = NUM(0.0);
    winding_set_resistance(&x->winding, model, resistance);
    x->mid_period = sincos_of(position.fraction);
}

#endif
