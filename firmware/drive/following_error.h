/*
 * How far a rotor with an encoder may be from its reference: it is jammed, overloaded, or its
 * encoder does not count what it does. What a law takes back in good time, such as a step, is none.
 */
#ifndef STEADYSTEP_FOLLOWING_ERROR_H
#define STEADYSTEP_FOLLOWING_ERROR_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/motor/per_unit.h"
#include "firmware/numeric/num.h"

struct following_error_params {
    num_t limit;      /* electrical turns; 0: is not watched */
    num_t approach;   /* per-unit speed that takes the limit back in a quarter of a second */
    uint32_t periods; /* from look to look, 1 ms */
};

struct following_error {
    uint32_t looks; /* in a row in which the error was too large and not on its way back */
};

struct following_error_task {
    const struct per_unit *base;
    double period_s;
    double limit_rad; /* mechanical, 0: is not watched */
};

__attribute__((cold)) struct following_error_params
following_error_design(const struct following_error_task *task);

void following_error_reset(struct following_error *following);

/*
 * A look, with reference less rotor: electrical turns, per-unit speed. true: for 10 ms the error
 * has been beyond the limit and not on its way back.
 */
bool following_error_exceeds(struct following_error *following,
                             const struct following_error_params *params, num_t error,
                             num_t speed_error);

#endif
