/* The limit of the voltage vector, for current control and voltage laws alike. */
#ifndef STEADYSTEP_VOLTAGE_LIMIT_H
#define STEADYSTEP_VOLTAGE_LIMIT_H

#include "firmware/motor/park.h"

/* Whether the vector may be longer: one that is not passes the limit as it is. */
static inline bool exceeds_voltage(struct dq v, num_t limit)
{
    return num_abs(v.d) + num_abs(v.q) > limit;
}

/* d keeps the field orientation, so it is served first; q gets the rest of the circle. */
static inline struct dq limit_voltage(struct dq v, num_t limit)
{
    struct dq limited = v;

    if (exceeds_voltage(v, limit)) {
        limited.d = num_limit(v.d, limit);
        limited.q = num_limit(v.q, num_sqrt(num_mul(limit, limit) - num_mul(limited.d, limited.d)));
    }
    return limited;
}

#endif
