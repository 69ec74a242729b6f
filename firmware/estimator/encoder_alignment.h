/*
 * Where the counts of an incremental encoder begin, found with a rotor that is held.
 *
 * A d current holds the rotor like a compass needle and leads it over the electrical turn around
 * its final angle, three times up and three times down. On each way it stops at seven angles, a
 * seventh of a turn apart; there the drive waits until the counts say that the rotor is at rest,
 * and reads by how much they differ from the held angle. In the means over a way
 *
 *   what repeats with the electrical angle cancels, up to its sixth multiple and above the seventh:
 *     offsets (N) and gains (2 N) of the current sensors, detent torque (N, 2 N, 4 N; with its
 *     slope 8 N);
 *   the count's rounding is a seventh: the angles meet the count at seven places;
 *   friction is a lag, the same on the way down as on the way up;
 *   a lasting load is a displacement, sin d = T / (Km i).
 *
 * Four of the ways are made with half the current, where lag and displacement double. So, with the
 * means m of both ways at the stronger current and m' of those at the weaker, in electrical rad:
 *
 *   sin(d + m' - m) = 2 sin d   =>   d = (m' - m) - (m' - m)^3 + O((m' - m)^5),   zero = m - d
 *
 * The order of the ways is up', down, up', down', up, down'. A load that comes or goes between two
 * ways that should be the same makes them differ by twice its d, and falsifies the zero by at most
 * half of that; one that is there on a single way at the stronger current, by (lag' - 2 lag), in
 * which friction cancels. And each angle shows a zero of its own, in which load and detent torque
 * cancel: an end stop, or a load that comes and goes within a way, makes one differ from their
 * mean.
 *
 * Not found: a rotor that does not come to rest; one that does not follow (it is held, no current
 * flows, the encoder is dead, reversed or of another number of counts); a load beyond a third or
 * friction beyond a fifth of what the stronger current holds; ways or angles that contradict each
 * other by more than the bound of the error, 3 degrees electrical or 3/4 of a count, whichever is
 * more.
 *
 * At rest: for two swings of the held rotor, 2 pi / sqrt(N Km i / J) each, the counts stay within
 * one or within a degree electrical, and within one more after five swings, since a hold that damps
 * by counts may keep a rotor swinging within them. So no turning point is taken for rest, not with
 * several times the inertia either, and what is left of a swing falls out of the mean.
 */
#ifndef STEADYSTEP_ENCODER_ALIGNMENT_H
#define STEADYSTEP_ENCODER_ALIGNMENT_H

#include "firmware/motor/encoder.h"
#include "firmware/motor/held_angle.h"
#include "firmware/motor/motor_params.h"
#include "firmware/motor/per_unit.h"

enum { ALIGNMENT_WEAK, ALIGNMENT_STRONG, ALIGNMENT_CURRENTS };
enum { ALIGNMENT_ANGLES = 7 };

/* In this order, so that no load that comes or goes on the way passes for a lasting one. */
enum encoder_alignment_way {
    ALIGNMENT_UP_WEAK,
    ALIGNMENT_DOWN_STRONG,
    ALIGNMENT_UP_WEAK_AGAIN,
    ALIGNMENT_DOWN_WEAK,
    ALIGNMENT_UP_STRONG,
    ALIGNMENT_DOWN_WEAK_AGAIN,
    ALIGNMENT_WAYS
};

/* Of a rotor held by one of the two currents. */
struct alignment_hold {
    num_t current;
    num_t tolerance; /* of the current that flows */
    uint32_t look;   /* periods for which it must rest */
    coef_t per_look; /* 1 / look */
    struct held_angle_params lead;
};

struct encoder_alignment_params {
    struct encoder_params encoder;
    struct alignment_hold hold[ALIGNMENT_CURRENTS];
    coef_t speed_per_turn; /* of an electrical turn in a period */
    int32_t spacing;       /* of the angles */
    int32_t interleave;    /* of those on the way down */
    uint32_t band;         /* counts within which a rotor is at rest */
    uint32_t patience;     /* periods for one angle */
    uint32_t settling;     /* periods at the last angle before it is looked at */
    num_t deviation_max;   /* electrical turns, as the two below */
    num_t load_min;        /* smaller changes of the mean with the current are none */
    num_t load_max;
    num_t friction_max;
    num_t error_max;      /* of a rotor's angle by its count */
    num_t zero_error_max; /* as above, without half a count */
    num_t outlier_max;
};

enum encoder_alignment_stage {
    ALIGNMENT_ALIGNING, /* to the final angle and, since opposite it there is no torque, beside it
                         */
    ALIGNMENT_SWEEPING, /* over the electrical turn around it */
    ALIGNMENT_ENDING,   /* at the final angle */
    ALIGNMENT_FOUND,
    ALIGNMENT_NOT_FOUND
};

struct encoder_alignment {
    enum encoder_alignment_stage stage;
    enum encoder_alignment_way way;
    uint32_t stop;    /* on the way; the first is 1 */
    uint32_t periods; /* since the held angle began to move to it */
    struct held_angle held;

    /* the present look at a rotor that may be at rest */
    uint32_t looked;
    int32_t lowest, highest;
    num_t mean;

    int32_t count;        /* with which the travel began */
    int32_t count_offset; /* and the offset */
    int32_t deviation;    /* of the rotor from the held angle, by that travel */

    /* results */
    num_t deviation_on_way[ALIGNMENT_WAYS]; /* means, electrical turns */
    num_t zero_at[ALIGNMENT_ANGLES];        /* as each angle alone shows it, of a seventh */
    num_t zero;                             /* deviation of a rotor without load */
    int32_t rotor;                          /* beyond the final angle */
};

struct encoder_alignment_task {
    const struct per_unit *base;
    const struct motor_params *motor;
    uint32_t counts_per_turn;
    double period_s;
    double current_A;  /* the stronger one */
    double settling_s; /* at the final angle, with that current */
};

__attribute__((cold)) struct encoder_alignment_params
encoder_alignment_design(const struct encoder_alignment_task *task);

/* Before the rotor is held. */
void encoder_alignment_start(struct encoder_alignment *alignment, int32_t count);

enum encoder_alignment_event {
    ALIGNMENT_GOES_ON,
    ALIGNMENT_PLACES, /* the rotor is now at `rotor` */
    ALIGNMENT_FAILS   /* the stage is not-found */
};

/*
 * One period, with the count of S(k) and the d current that is known to flow: whether the rotor is
 * at rest at the held angle, and the next one. Runs from flash: it is not part of operation.
 */
enum encoder_alignment_event encoder_alignment_step(struct encoder_alignment *alignment,
                                                    const struct encoder_alignment_params *params,
                                                    int32_t count, num_t current);

static inline bool encoder_alignment_weak(enum encoder_alignment_way way)
{
    return way != ALIGNMENT_DOWN_STRONG && way != ALIGNMENT_UP_STRONG;
}

/* The rotor is drawn in with the weak current, too. */
static inline const struct alignment_hold *
encoder_alignment_hold(const struct encoder_alignment *alignment,
                       const struct encoder_alignment_params *params)
{
    const bool weak =
        alignment->stage == ALIGNMENT_ALIGNING ||
        (alignment->stage == ALIGNMENT_SWEEPING && encoder_alignment_weak(alignment->way));

    return &params->hold[weak ? ALIGNMENT_WEAK : ALIGNMENT_STRONG];
}

/* The held angle's, mechanical. */
static inline num_t encoder_alignment_speed(const struct encoder_alignment *alignment,
                                            const struct encoder_alignment_params *params)
{
    return num_mul_coef(held_angle_turned(&alignment->held), params->speed_per_turn);
}

/* What is to hold the rotor in the coming period. */
static inline num_t encoder_alignment_current(const struct encoder_alignment *alignment,
                                              const struct encoder_alignment_params *params)
{
    return encoder_alignment_hold(alignment, params)->current;
}

#endif
