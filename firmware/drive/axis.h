/*
 * Where the axis is, beyond what estimate and reference say: the user's coordinates, what is known
 * of them, and the rotor while the bridge is off.
 *
 * Everything in the drive is in the motor's coordinates, whose fraction of a turn is the electrical
 * angle. A position that is commanded or shown is `offset` further: set-position changes that and
 * nothing else, so neither currents nor angle know of it. All positions go round at 2^31
 * electrical turns.
 *
 * While the drive is switched off the reference is where the rotor is known to be, and enabling
 * begins there: with an encoder that counts it follows the rotor; without one it stays where the
 * rotor was last held or estimated.
 */
#ifndef STEADYSTEP_AXIS_H
#define STEADYSTEP_AXIS_H

#include "firmware/interface/drive_interface.h"
#include "firmware/motor/encoder.h"

struct axis {
    struct encoder encoder; /* while the bridge is off: where the rotor was left, or is counted */
    struct position offset; /* the user's coordinates less the motor's */
    struct position origin; /* the motor's zero, a constant: a signal shows it */
    enum drive_position_reference reference;
    bool counts;     /* the encoder does, while the bridge is off */
    bool aligned;    /* its zero has been found, and nothing has questioned it since */
    bool seeks_stop; /* the background is homing on a hard stop */
};

struct drive;

/* Start-up, and background before another design: whether these settings ask for other coordinates
   than those in force. */
bool axis_begins_anew(const struct drive_settings *in_force, const struct drive_settings *given);

/* Start-up, and background with the bridge off: the rotor is where the settings assume it. */
void axis_begin(struct drive *drive);

/* With the bridge off: where the rotor was left, or is counted. */
struct position axis_kept_position(const struct drive *drive);

/* Switched off: where enabling begins. The encoder's zero counts until it has been enabled
   once. */
struct position axis_position(const struct drive *drive, struct position encoder_zero);

/* Interrupt: the drive is ready. */
void axis_note_ready(struct drive *drive);

/* Interrupt: the bridge opens, before the state says so. `fault`: why, or none. */
void axis_note_bridge_off(struct drive *drive, enum drive_fault fault);

/* Interrupt: what stands from then on as the reference is where enabling begins. A fault shows both
   as they were when it came. */
void axis_note_disabled(struct drive *drive);

/* Interrupt: the rotor may no longer be where it is said to be. */
void axis_note_uncertain(struct drive *drive);

/* Interrupt, with the bridge off and an encoder that counts: takes the reference along with the
   rotor as it is counted. */
void axis_follow_encoder(struct drive *drive);

/* Interrupt, at rest or with the bridge off: the reference's position is this one. */
void axis_set_position(struct drive *drive, struct position position);

#endif
