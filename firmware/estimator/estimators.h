/*
 * The registry of estimators: ESTIMATOR(name of the constant, of files, functions and members).
 *
 * An estimator is a header and a source of its own and one line here. It has
 *
 *   struct <estimator>_params   constants, scaled from what design/ computes
 *   struct <estimator>          state; begins with a struct estimate
 *   <estimator>_begin           when the bridge is switched on, from a struct estimator_start
 *   <estimator>_observe         one period, from a struct estimator_input: corrects what was
 *                               predicted for S(k), and predicts
 *
 * and, without an encoder,
 *
 *   <estimator>_preset_current  behind begin: this current flows already; estimator_predict is to
 * follow <estimator>_preset_rotor    at rest: the rotor is known from elsewhere; estimator_predict
 * is to follow
 *
 * or, with one,
 *
 *   <estimator>_place           the rotor is at a position with this count
 */
#ifndef STEADYSTEP_ESTIMATORS_H
#define STEADYSTEP_ESTIMATORS_H

#include "firmware/simulation.h"

#define SENSORLESS_ESTIMATORS(ESTIMATOR)                                                           \
    ESTIMATOR(INVARIANT_EKF, invariant_ekf)                                                        \
    ESTIMATOR(STEADY_STATE_EKF, steady_state_ekf)

/* The first one is designed for the others, too. */
#define ENCODER_ESTIMATORS(ESTIMATOR)                                                              \
    ESTIMATOR(ENCODER_OBSERVER, encoder_observer)                                                  \
    ESTIMATOR(HIGH_GAIN_OBSERVER, high_gain_observer)

#define ESTIMATORS(ESTIMATOR)                                                                      \
    SENSORLESS_ESTIMATORS(ESTIMATOR)                                                               \
    ENCODER_ESTIMATORS(ESTIMATOR)

#define ESTIMATOR_ENUMERATE(constant, name) ESTIMATOR_##constant,
enum estimator_kind { ESTIMATORS(ESTIMATOR_ENUMERATE) };
#undef ESTIMATOR_ENUMERATE

#define ESTIMATOR_PLACE_IN_LIST(constant, name) ESTIMATOR_PLACE_##constant,
enum { ESTIMATORS(ESTIMATOR_PLACE_IN_LIST) ESTIMATOR_COUNT };
#undef ESTIMATOR_PLACE_IN_LIST

/* Behind the last one without an encoder. */
#define SENSORLESS_PLACE_IN_LIST(constant, name) SENSORLESS_PLACE_##constant,
enum { SENSORLESS_ESTIMATORS(SENSORLESS_PLACE_IN_LIST) ESTIMATOR_ENCODER_FIRST };
#undef SENSORLESS_PLACE_IN_LIST

/* Those in an image: all; all but the last, the simulation's; or, for a board that reads no
   encoder, what goes without one. */
#ifdef STEADYSTEP_WITHOUT_ENCODER
enum { ESTIMATOR_KINDS = ESTIMATOR_ENCODER_FIRST };
#else
enum { ESTIMATOR_KINDS = ESTIMATOR_COUNT - (SERVES_SIMULATION ? 0 : 1) };
#endif
enum { ESTIMATORS_READ_ENCODER = (int)ESTIMATOR_KINDS > (int)ESTIMATOR_ENCODER_FIRST };

#endif
