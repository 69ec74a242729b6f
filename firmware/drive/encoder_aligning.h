/*
 * While the drive is being enabled: an encoder's zero, found by a hold that leads the rotor over an
 * electrical turn and to its final angle (estimator/encoder_alignment.h).
 * STEADYSTEP_WITHOUT_ENCODER, for a board that reads none, leaves it out of the image: enabling
 * then ends in position-not-found.
 */
#ifndef STEADYSTEP_ENCODER_ALIGNING_H
#define STEADYSTEP_ENCODER_ALIGNING_H

#include "firmware/design/hold_check.h"
#include "firmware/drive/drive.h"

enum encoder_aligning { ENCODER_ALIGNING, ENCODER_ALIGNED, ENCODER_NOT_ALIGNED };

#ifdef STEADYSTEP_WITHOUT_ENCODER

static inline double encoder_aligning_current_A(const struct drive_settings *settings,
                                                struct hold_task hold)
{
    (void)hold;
    return settings->hold_current_A;
}

static inline void encoder_aligning_design(struct drive *drive,
                                           const struct drive_settings *settings, double period_s,
                                           double current_A)
{
    (void)drive;
    (void)settings;
    (void)period_s;
    (void)current_A;
}

static inline void encoder_aligning_start(struct drive *drive)
{
    (void)drive;
}

static inline enum encoder_aligning encoder_aligning_step(struct drive *drive)
{
    (void)drive;
    return ENCODER_NOT_ALIGNED;
}

#else

/*
 * The stronger current of an encoder's alignment: what the motor may have for long and the trip
 * lets pass, or the hold's if that is more or the hold does not damp a rotor on so stiff a spring.
 */
double encoder_aligning_current_A(const struct drive_settings *settings, struct hold_task hold);

void encoder_aligning_design(struct drive *drive, const struct drive_settings *settings,
                             double period_s, double current_A);

/* Before the rotor is held. */
void encoder_aligning_start(struct drive *drive);

/* One period: the hold's angle, speed and current; when the rotor rests, where the estimate has it.
 */
enum encoder_aligning encoder_aligning_step(struct drive *drive);

#endif

#endif
