/*
 * Where the rotor stands, found at rest before the drive is ready.
 *
 * By impulses (Bendjedia 2012, sections I and V): the magnet's flux biases the iron of each phase,
 * so that an impulse of voltage that adds to it draws more current than one against it. With
 * i = lambda/L0 + beta lambda^3 - I_f cos(phi) an impulse of +-Delta from zero current leads to
 *
 *   i(+Delta) + i(-Delta) = 6 beta L0 I_f Delta^2 cos(phi),   sin(phi) in phase b
 *
 * whose sign distinguishes the two ends of the magnet. What a motor without saturation would have
 * drawn under the voltages that were measured is taken off each sample first, so that dead time, a
 * bus that sags, and unequal impulses leave nothing.
 *
 * An impulse also pushes the rotor, and the speed that it leaves behind disturbs the next one. The
 * published order + - in each phase suffers from that; the order + - - + brings the rotor back to
 * rest where it was, and what its speed does cancels. A second round, with
 * signs and phases exchanged, shows by what it differs how sure the answer is.
 *
 * By alignment, where the iron shows too little: a voltage vector draws the rotor in, turned by a
 * current controlled so slowly that the winding's resistance damps the swing. The vector then goes
 * a quarter turn on and back. The flux that the rotor brings along, the integral of u - R i less
 * L times the change of i, must be that of the magnet turned by a quarter: else it has not
 * followed, and the position has not been found.
 *
 * The caller runs one step a period with the samples of S(k), and gives the bridge what it returns.
 */
#ifndef STEADYSTEP_INITIAL_POSITION_H
#define STEADYSTEP_INITIAL_POSITION_H

#include "firmware/design/refusal.h"
#include "firmware/estimator/impulse_order.h"
#include "firmware/motor/motor_model.h"

/* The order of the impulses. */
enum impulse_order {
    IMPULSE_ORDER_PALINDROMIC, /* + - - + in phase a, then b; then negated, b first */
    IMPULSE_ORDER_PUBLISHED    /* + - in phase a, then b; once */
};

struct initial_position_params {
    struct motor_model_params model;
    enum impulse_order order;
    uint32_t lag;             /* periods from a command to its action: 1, or 0 in a simulation */
    uint32_t impulse_periods; /* of voltage */
    num_t impulse_voltage;
    num_t response_min; /* sum of a phase's peaks by 16 */
    num_t response_max;
    coef_t per_response;                 /* 1 / what a phase's should be */
    uint32_t quiet_begin, quiet_periods; /* until offsets are added up, and in which they are */
    unit_t per_quiet_period;
    num_t quiet_max;         /* a larger offset is the current of a rotor that turns */
    num_t quiet_voltage_max; /* a larger one shows sensing that is out of order */
    num_t listened_max;      /* of a sample, so that their sum stays in range */
    num_t floor_squared;     /* of what may pass for an asymmetry without being one, in the sum */
    coef_t certainty;        /* square of the least confidence */

    num_t alignment_current;
    num_t current_ramp;  /* per period */
    coef_t current_gain; /* voltage per period and current */
    coef_t resistance_gain;
    coef_t flux;             /* magnet fluxes per voltage and period */
    coef_t flux_per_current; /* L in these units */
    uint32_t aligning_periods;
    uint32_t quarter_periods; /* in which the vector turns by a quarter */
    angle_t quarter_step;     /* per period */
    uint32_t rest_periods;    /* in which the rotor comes to rest behind it */
};

enum initial_position_stage {
    INITIAL_POSITION_QUIET,    /* bridge on, no voltage: offsets that come with the bridge */
    INITIAL_POSITION_IMPULSES, /* one after the other */
    INITIAL_POSITION_ALIGNING, /* alignment: the current comes in, the rotor comes to rest */
    INITIAL_POSITION_OFFSET,   /* the vector goes a quarter turn on, the resistance is measured */
    INITIAL_POSITION_FINAL,    /* it comes back, the flux is summed up */
    INITIAL_POSITION_FOUND,
    INITIAL_POSITION_NOT_FOUND
};

struct initial_position {
    enum initial_position_stage stage;
    uint32_t periods; /* of the stage, or of the present impulse */

    /* impulses */
    struct winding winding;
    struct phases current_offset; /* with the bridge on */
    struct phases voltage_offset;
    uint32_t impulse;                    /* number of the present one */
    struct phases expected;              /* current of a motor without saturation */
    struct phases round[IMPULSE_ROUNDS]; /* sums of what the samples differ from that */
    struct phases response;              /* sums of all peaks by 16 */
    uint32_t repetitions;                /* because the rotor was turning */

    /* alignment */
    angle_t final_angle;
    angle_t direction; /* of the vector */
    num_t current_reference;
    num_t voltage; /* along the vector */
    num_t resistance;
    struct phases flux; /* that the rotor has brought along; the magnet's is one */
    struct phases current_before;
    uint32_t attempts;

    /* results */
    bool by_impulses;  /* else by alignment */
    angle_t angle;     /* electrical, of the rotor */
    num_t asymmetry;   /* of the impulses, in sums of eight */
    num_t uncertainty; /* standard error of it, and what may pass for it */
};

struct initial_position_task {
    double period_s;
    bool zero_delay;
    enum impulse_order order;
    double current_A_per_code;
    double current_range_A;
    double overcurrent_trip_A;
    double hold_current_A; /* of the alignment */
    double hold_ramp_s;
};

/* Share of the overcurrent trip that a current is to reach at most; saturation adds up to a fifth.
 */
#define INITIAL_POSITION_PEAK 0.7

/* The current at the end of an impulse, of a motor without saturation. */
double initial_position_peak_A(const struct initial_position_task *task);

/*
 * Impulses as strong as the overcurrent trip allows; false: the motor or the trip leaves none,
 * reason in error.
 */
__attribute__((cold)) bool initial_position_design(struct initial_position_params *params,
                                                   const struct motor_model_params *model,
                                                   const struct motor_params *motor,
                                                   const struct per_unit *base,
                                                   const struct initial_position_task *task,
                                                   char error[DESIGN_ERROR_TEXT]);

/* Begins with the bridge open and the rotor at rest. An alignment draws the rotor to `final_angle`.
 */
void initial_position_start(struct initial_position *detection,
                            const struct initial_position_params *params, angle_t final_angle);

/* What the bridge is to do. */
struct initial_position_output {
    bool bridge_on;
    bool compensated; /* the voltage is to reach the motor, whatever the bridge takes of it */
    struct phases voltage;
};

/*
 * One period: currents of S(k), voltages the means over S(k-1)...S(k). In the stages found and not
 * found nothing is left to do; an alignment that has found leaves its current flowing.
 */
struct initial_position_output initial_position_step(struct initial_position *detection,
                                                     const struct initial_position_params *params,
                                                     struct phases current, struct phases voltage);

/*
 * The asymmetry, had the impulses had the size they were designed for: a supply that sags makes
 * them smaller, and it goes with their square.
 */
num_t initial_position_full_asymmetry(const struct initial_position *detection,
                                      const struct initial_position_params *params);

/* Background: the asymmetry over its uncertainty; below 5 the impulses are not relied on. */
double initial_position_confidence(const struct initial_position *detection);

static inline bool initial_position_done(const struct initial_position *detection)
{
    return detection->stage >= INITIAL_POSITION_FOUND;
}

#endif
