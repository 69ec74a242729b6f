/* Per-unit numbers compared with their value in double; what the number formats resolve. */
#ifndef STEADYSTEP_NUM_ASSERT_H
#define STEADYSTEP_NUM_ASSERT_H

#include <unity.h>

#include "firmware/numeric/num.h"

#define TEST_ASSERT_NUM_WITHIN(tolerance, expected, actual)                                        \
    TEST_ASSERT_DOUBLE_WITHIN((tolerance), (expected), num_to_double(actual))

/*
 * NUM_ROUNDING   of one operation on quantities of about one, per-unit
 * COEF_ROUNDING  of a gain, relative
 * SINE_ERROR     of trig.h
 */
#if STEADYSTEP_NUM == NUM_FIXED
#define NUM_ROUNDING (1.0 / 67108864.0)
#ifdef STEADYSTEP_COEFFICIENT_SHIFTS
#define COEF_ROUNDING (1.0 / 8192.0) /* two bits are room */
#else
#define COEF_ROUNDING (1.0 / 32768.0)
#endif
#define SINE_ERROR 1e-4
#elif STEADYSTEP_NUM == NUM_FLOAT
#define NUM_ROUNDING  (1.0 / 8388608.0)
#define COEF_ROUNDING (1.0 / 16777216.0)
#define SINE_ERROR    1.3e-7
#else
#define NUM_ROUNDING  1e-15
#define COEF_ROUNDING 1e-15
#define SINE_ERROR    1.3e-7
#endif

#endif
