/*
 * States of the drive (CiA 402 names) and what leads from one to the next:
 *
 *   switch-on-disabled --enable--> calibrating-offsets --> detecting-position --> aligning -->
 *          ^                                                           operation-enabled
 *          |                                                                  |
 *          +-------------------- disable (from anywhere) <--------------------+
 *   any state with the bridge on --protection--> fault --disable--> switch-on-disabled
 *
 * All three steps of enabling can be left out by the settings.
 */
#ifndef STEADYSTEP_STATE_MACHINE_H
#define STEADYSTEP_STATE_MACHINE_H

#include "firmware/drive/drive.h"

/* First of all in a control interrupt; returns the index of the period. */
static inline uint32_t state_machine_begin_period(struct drive *drive)
{
    const uint32_t period = drive->supervision.period + 1u;

    drive->supervision.period = period;
    return period;
}

/*
 * At most one rare thing a period, so that no interrupt pays for two: what has its time, commands
 * that act and what begins with them, claims the period, and what can wait leaves a claimed one
 * alone.
 */
static inline void state_machine_claim_period(struct drive *drive)
{
    drive->supervision.claimed = drive->supervision.period;
}

static inline bool state_machine_period_is_claimed(const struct drive *drive)
{
    return drive->supervision.claimed == drive->supervision.period;
}

/* The bridge is on and the control runs; detecting-position has the bridge for itself. */
static inline bool state_machine_powered(const struct drive *drive)
{
    return drive->supervision.state == DRIVE_OPERATION_ENABLED ||
           drive->supervision.state == DRIVE_ALIGNING;
}

/*
 * One period outside operation, behind the reference's step: takes due commands and the steps of
 * enabling. true: the bridge was on before and stays on. The period that powers up only resets the
 * blocks, so that no interrupt pays for both.
 */
bool state_machine_step(struct drive *drive, const struct hal_samples *samples);

/* In operation, when a command is due; true: it goes on. */
bool state_machine_obey(struct drive *drive, const struct hal_samples *samples);

/* Enters the fault that the samples show, if any. Apart: rare. */
__attribute__((noinline)) void state_machine_check_samples(struct drive *drive,
                                                           const struct hal_samples *samples);

/* The steps of enabling behind detecting-position: the rotor stands at this electrical angle. */
void state_machine_position_found(struct drive *drive, angle_t angle);

/* The bridge while nothing controls it: off; in the second stage of the offsets' calibration on,
   all legs at half duty. */
struct hal_outputs state_machine_resting_bridge(const struct drive *drive);

/* Background: the next interrupt enters the fault state, if the drive is in operation still. */
void state_machine_ask_for_fault(struct drive *drive, enum drive_fault fault);

/*
 * Background, of a rotor that may be anywhere: the next interrupt aligns it anew, if the drive is
 * in operation still and no fault has been asked for. The reference stops where the rotor is
 * estimated, and the first hold begins anew, with all of its current, which draws the rotor there
 * to within whole electrical turns; then the drive is in operation again. What is known of the
 * winding stays; the position is uncertain.
 */
void state_machine_ask_to_realign(struct drive *drive);

/* Enters the fault state if there is a fault; the bridge opens in the same period. */
void state_machine_fault(struct drive *drive, enum drive_fault fault);

#endif
