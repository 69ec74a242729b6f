#include "firmware/drive/planner.h"

#include <stddef.h>

#include "firmware/drive/interrupt_view.h"

#define LEAD_PERIODS_MIN 3u

/* What passes for standing still, electrical turns per period^n: 2^-40, far below an angle_t. */
static const double still = 9.094947017729282e-13;

static uint32_t lead_periods(const struct drive *drive, double lead_s)
{
    const double lead = lead_s / drive->board->facts->control_period_s + 0.5;

    return (uint32_t)lead > LEAD_PERIODS_MIN ? (uint32_t)lead : LEAD_PERIODS_MIN;
}

uint32_t planner_lead_periods(const struct drive *drive)
{
    return lead_periods(drive, DRIVE_LEAD_s);
}

/*
 * A copy of the reference as it will be before the interrupt `at_period`, unless something
 * intervenes. false: a stop is being acted on, or the period has passed.
 */
static bool foresee(const struct drive *drive, uint32_t at_period, struct reference *copy)
{
    const uint32_t period = interrupt_view_reference(drive, copy);

    if (copy->stop_requested || (int32_t)(at_period - period) <= 0) {
        return false;
    }
    reference_skip(copy, at_period - period - 1u);
    return true;
}

/* The one the reference does not follow. Nothing may be on offer. */
static struct motion_plan *free_plan(struct drive *drive)
{
    struct planner *p = &drive->planner;

    reference_continue(&drive->reference, NULL);
    return interrupt_view_plan(drive) == &p->plan[0] ? &p->plan[1] : &p->plan[0];
}

void planner_follow(struct drive *drive)
{
    struct planner *p = &drive->planner;
    struct command_queue *queue = &drive->commands;
    const uint32_t epoch = interrupt_view_epoch(drive);

    if (p->epoch != epoch) { /* a reset, the stop of a plan, or torque mode */
        command_queue_withdraw_preemption(queue);
        reference_continue(&drive->reference, NULL);
        p->epoch = epoch;
        p->offered = NULL;
        p->motion = PLANNER_IDLE;
        p->set_points_open = false;
        p->stop_due = !interrupt_view_torque(drive);
        if (drive->reference.phase != REFERENCE_PLANNED) { /* a reset */
            p->lead_periods = lead_periods(drive, DRIVE_LEAD_s);
        }
    }
    if (p->set_points_open && p->motion != PLANNER_SET_POINTS && p->offered == NULL &&
        (int32_t)(queue->read - p->set_points_command) > 0) {
        p->set_points_open = false; /* flushed */
    }
}

/* What has become of the plan that was to preempt. */
static void settle_offer(struct drive *drive)
{
    struct planner *p = &drive->planner;
    struct command_queue *queue = &drive->commands;

    if (p->offered == NULL) {
        return;
    }
    if (queue->preemption.posted) {
        if ((int32_t)(interrupt_view_period(drive) - queue->preemption.at_period) <= 0) {
            return;
        }
        command_queue_withdraw_preemption(queue); /* a stop or disable came first */
    }
    if (drive->reference.plan == p->offered) {
        p->last = p->offered;
        p->motion = p->offered_motion;
        p->stop_due = p->stop_due && !p->offered_is_stop;
        p->lead_periods = lead_periods(drive, DRIVE_LEAD_s);
    } else {
        const bool wanted = p->offered_is_stop || queue->preemption.command == queue->read;
        const uint32_t longest = lead_periods(drive, DRIVE_LEAD_MAX_s);

        if (wanted) {
            p->lead_periods *= 2u;
            p->lead_periods = p->lead_periods < longest ? p->lead_periods : longest;
        }
        if (p->offered_motion == PLANNER_SET_POINTS) {
            set_points_rewind(&p->set_points, motion_position(&p->offered->from));
        }
    }
    p->offered = NULL;
}

static void offer(struct drive *drive, const struct preemption *preemption,
                  enum planner_motion motion)
{
    struct planner *p = &drive->planner;

    p->offered = preemption->plan;
    p->offered_motion = motion;
    p->offered_is_stop = !preemption->of_command;
    command_queue_put_preemption(&drive->commands, preemption);
}

/* Behind the point of continuation, to rest in case the continuation does not come. */
static void append_tail(struct planner *p, struct motion_plan *plan)
{
    struct motion_state end = p->end;
    const double speed = motion_to_turns(end.speed);
    const double acceleration = motion_to_turns(end.acceleration);

    if (speed > still || speed < -still || acceleration > still || acceleration < -still) {
        motion_plan_speed(plan, &end, 0.0, &p->limits);
    }
}

/* Plans the next part of what goes on; false: there is nothing to plan yet. */
static bool continue_plan(struct planner *p, struct motion_plan *plan)
{
    if (p->motion == PLANNER_SET_POINTS) {
        if (!set_points_continue(&p->set_points, plan, &p->end)) {
            return false;
        }
        append_tail(p, plan);
    } else if (sine_continue(&p->sine, plan, &p->end)) {
        append_tail(p, plan);
    }
    return true;
}

/* The plan in force has passed its point of continuation, or the drive its rest: nothing can follow
 * it. */
static bool too_late(const struct drive *drive)
{
    const struct reference *r = &drive->reference;

    return r->phase != REFERENCE_PLANNED || r->segment > r->plan->continues_after;
}

static void end_motion(struct drive *drive)
{
    struct planner *p = &drive->planner;
    const struct motion_plan *plan = drive->reference.plan;

    p->motion = PLANNER_IDLE;
    p->set_points_open = false;
    if (plan->segments > plan->continues_after) { /* it had to be brought to rest */
        p->underruns++;
    }
}

static void continue_motion(struct drive *drive)
{
    struct planner *p = &drive->planner;
    struct reference *r = &drive->reference;
    struct motion_plan *plan;

    if (too_late(drive)) {
        reference_continue(r, NULL);
        end_motion(drive);
        return;
    }
    if (r->plan != p->last) {
        return; /* the continuation has not been taken yet */
    }
    if (p->last->continues_after > PLAN_SEGMENTS) {
        p->motion = PLANNER_IDLE; /* the end of the sine */
        return;
    }
    plan = free_plan(drive);
    motion_plan_begin(plan, &p->end, p->epoch);
    plan->creeps = p->creeps;
    if (continue_plan(p, plan)) {
        p->last = plan;
        reference_continue(r, plan);
    }
}

/* Where the plan that preempts in `at_period` begins. */
static bool begin_plan(struct drive *drive, struct motion_plan *plan, uint32_t at_period)
{
    struct planner *p = &drive->planner;
    struct reference copy;

    if (!foresee(drive, at_period, &copy)) {
        return false;
    }
    motion_plan_begin(plan, &copy.at, p->epoch);
    p->end = copy.at;
    if (copy.periods_left > 0u) {
        motion_run(&p->end, reference_jerk_sixth(&copy), 1u);
    }
    return true;
}

/*
 * A lead after the period in which the stop acted, so that it does not matter how soon the
 * background comes to it; if that is later than half a lead, a lead from now.
 */
static uint32_t stop_period(const struct drive *drive)
{
    const uint32_t lead = drive->planner.lead_periods;
    const uint32_t now = interrupt_view_period(drive);
    const uint32_t acted = drive->commands.stop_acted_in;

    return (now - acted <= lead / 2u ? acted : now) + lead;
}

static void stop(struct drive *drive)
{
    struct planner *p = &drive->planner;
    const uint32_t at_period = stop_period(drive);
    struct motion_plan *plan;

    if (drive->reference.phase != REFERENCE_PLANNED) {
        p->stop_due = false; /* rests, or has been reset */
        return;
    }
    plan = free_plan(drive);
    if (begin_plan(drive, plan, at_period)) {
        motion_plan_speed(plan, &p->end, 0.0, &p->limits);
        plan->creeps = p->creeps;
        offer(drive, &(struct preemption){.at_period = at_period, .plan = plan}, PLANNER_IDLE);
    }
}

/* From rest: sine and set-points. */
static enum planner_motion begin_motion(struct planner *p, struct motion_plan *plan,
                                        const struct queued_command *command)
{
    const bool sine = command->kind == DRIVE_COMMAND_SINE;

    p->motion = sine ? PLANNER_SINE : PLANNER_SET_POINTS;
    if (sine) {
        p->sine = command->request.sine;
        p->sine.centre = motion_position(&p->end);
    }
    (void)continue_plan(p, plan);
    return p->motion;
}

/* Electrical turns per period. */
static double creep_speed(const struct drive *drive)
{
    return num_to_double(drive->params.reference.creep_speed) * drive->base.turns_per_period;
}

/* Its cruise, or the peak of a sine; of set-points nobody knows. */
static bool creeps(const struct queued_command *command, double creep_speed)
{
    const struct motion_request *request = &command->request;

    switch (command->kind) {
    case DRIVE_COMMAND_VELOCITY:
        return request->speed <= creep_speed && request->speed >= -creep_speed;
    case DRIVE_COMMAND_SET_POINT:
        return false;
    default:
        return request->limits.speed <= creep_speed;
    }
}

static enum planner_motion plan_command(struct planner *p, struct motion_plan *plan,
                                        const struct queued_command *command, double creep_speed)
{
    const struct motion_request *request = &command->request;

    p->limits = request->limits;
    p->creeps = creeps(command, creep_speed);
    plan->creeps = p->creeps;
    switch (command->kind) {
    case DRIVE_COMMAND_VELOCITY:
        motion_plan_speed(plan, &p->end, request->speed, &p->limits);
        if (request->speed != 0.0) {
            motion_plan_cruise(plan);
        }
        return PLANNER_IDLE;
    case DRIVE_COMMAND_RETARGET:
        motion_plan_move(plan, &p->end, request->target, &p->limits);
        return PLANNER_IDLE;
    default:
        return begin_motion(p, plan, command);
    }
}

/* Sine and set-points wait for rest, set-points for the second one as well. */
static bool may_begin(const struct drive *drive, const struct queued_command *command)
{
    if (command->kind == DRIVE_COMMAND_VELOCITY || command->kind == DRIVE_COMMAND_RETARGET) {
        return true;
    }
    return !reference_busy(&drive->reference) &&
           (command->kind == DRIVE_COMMAND_SINE ||
            set_points_waiting(&drive->planner.set_points) >= 2u);
}

/* The period a command is addressed to; set-points begin with the second one. */
static uint32_t addressed_to(const struct planner *p, const struct queued_command *command)
{
    return command->kind == DRIVE_COMMAND_SET_POINT &&
                   (int32_t)(p->set_points_at - command->at_period) > 0
               ? p->set_points_at
               : command->at_period;
}

/* The oldest command, if it is one to be planned and its period is near. */
static void take_command(struct drive *drive)
{
    struct planner *p = &drive->planner;
    const struct command_queue *queue = &drive->commands;
    const uint32_t entry = queue->read;
    const struct queued_command *command = &queue->entry[entry % COMMAND_QUEUE_LENGTH];
    const uint32_t earliest = interrupt_view_period(drive) + p->lead_periods;
    const uint32_t addressed = addressed_to(p, command);
    const int32_t wait = (int32_t)(addressed - earliest);
    const uint32_t at_period = wait > 0 ? addressed : earliest;
    struct motion_plan *plan;

    if (entry == queue->written || !queued_command_is_planned(command) ||
        drive->supervision.state != DRIVE_OPERATION_ENABLED || wait > (int32_t)p->lead_periods ||
        !may_begin(drive, command)) {
        return;
    }
    torque_mode_end(drive);
    plan = free_plan(drive);
    if (begin_plan(drive, plan, at_period)) {
        const enum planner_motion motion = plan_command(p, plan, command, creep_speed(drive));

        p->motion = PLANNER_IDLE; /* what has been going on ends */
        offer(drive,
              &(struct preemption){
                  .at_period = at_period, .plan = plan, .of_command = true, .command = entry},
              motion);
    }
}

void drive_background(struct drive *drive)
{
    struct planner *p = &drive->planner;

    planner_follow(drive);
    settle_offer(drive);
    if (p->offered != NULL) {
        return;
    }
    if (p->stop_due) {
        stop(drive);
    } else if (p->motion != PLANNER_IDLE) {
        continue_motion(drive);
    }
    if (p->offered == NULL && !p->stop_due && command_queue_holds_any(&drive->commands)) {
        take_command(drive);
    }
}

void planner_init(struct drive *drive)
{
    drive->planner.epoch = drive->reference.epoch;
    drive->planner.lead_periods = lead_periods(drive, DRIVE_LEAD_s);
}
