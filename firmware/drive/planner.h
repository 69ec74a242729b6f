/*
 * The planner: turns sines, set-points, speed changes, new targets and the stops of these into
 * plans for the reference (motion_plan.h). Everything here belongs to the background, which reaches
 * the interrupt by two pointers alone, each written when what it points to is complete:
 *
 *   preemption    a plan that begins in a given period, from where the reference will be then. That
 *                 is known from a copy of the reference, run ahead by the reference's own code. The
 *                 interrupt accepts it only if it is there indeed.
 *   continuation  a plan that begins at a point of the plan in force: a bumpless transfer.
 *
 * Two plans are kept: the one in force and the one offered.
 */
#ifndef STEADYSTEP_PLANNER_H
#define STEADYSTEP_PLANNER_H

#include "firmware/drive/command_queue.h"
#include "firmware/motion/motion_plan.h"
#include "firmware/motion/set_points.h"
#include "firmware/motion/sine.h"

/* What the plan in force belongs to. */
enum planner_motion {
    PLANNER_IDLE, /* nothing, or a plan that needs no continuation */
    PLANNER_SINE,
    PLANNER_SET_POINTS
};

struct planner {
    struct motion_plan plan[2];
    const struct motion_plan *offered; /* to preempt; NULL: none */
    const struct motion_plan *last;    /* the last one accepted or offered as continuation */
    struct motion_state end;           /* where `last` is continued */
    enum planner_motion motion;
    enum planner_motion offered_motion;
    bool offered_is_stop;
    bool stop_due; /* a stop has come: the plan in force has yet to be brought to rest */
    uint32_t epoch;
    uint32_t lead_periods;       /* DRIVE_LEAD_s; doubled by each offer that came too late, up to
                                    DRIVE_LEAD_MAX_s, until one is accepted or a reset */
    struct motion_limits limits; /* of the motion in force */
    bool creeps;                 /* that motion does */
    struct sine sine;
    struct set_points set_points;
    bool set_points_open;
    uint32_t set_points_command; /* queue entry that begins them */
    uint32_t set_points_at;      /* period to which the second one was addressed, or the first */
    uint32_t underruns;
};

/* A stream of set-points begins with this entry of the queue. */
static inline void planner_open_set_points(struct planner *planner, uint32_t command)
{
    planner->set_points_command = command;
    planner->set_points_open = true;
}

/* Before a set-point is put: while the stream has not begun, it begins with the second one. */
static inline void planner_address_set_point(struct planner *planner, uint32_t at_period)
{
    if (set_points_waiting(&planner->set_points) <= 1u) {
        planner->set_points_at = at_period;
    }
}

/* What goes on is not planned, but its stop will be, within these limits. */
static inline void planner_stop_within(struct planner *planner, const struct motion_limits *limits)
{
    planner->limits = *limits;
}

struct drive;

/*
 * Checks a command that is to be planned and states it in the units of the reference. false, with
 * the quantity, its value and the bound it breaks in `error`.
 */
bool planner_request(struct drive *drive, const struct drive_command *command,
                     struct motion_request *request, char error[DRIVE_ERROR_TEXT]);

/* The same of a torque, which is not planned but stopped by a plan. */
bool planner_request_torque(struct drive *drive, const struct drive_command *command,
                            struct torque_mode *asked, char error[DRIVE_ERROR_TEXT]);

/* DRIVE_LEAD_s in control periods. */
uint32_t planner_lead_periods(const struct drive *drive);

/* Start-up, when drive and reference are set up. */
void planner_init(struct drive *drive);

/* Follows what has happened to the reference: to be called before a command is posted. */
void planner_follow(struct drive *drive);

#endif
