/*
 * Capture: up to eight signals at the control rate or a whole part of it, into memory that the
 * board has left, around the crossing of a level. All values of a sample are of one control
 * interrupt, as they are in it: what they are in SI units is for the background to say.
 *
 * A drive that captures nothing does not know of it: the board runs it behind the control interrupt
 * while it is armed, and only then (hal.h, follow_control).
 */
#ifndef STEADYSTEP_CAPTURE_H
#define STEADYSTEP_CAPTURE_H

#include "firmware/design/text.h"
#include "firmware/drive/drive.h"

enum { CAPTURE_SIGNALS = 8, CAPTURE_VALUE_BYTES = 8 };

/* By the numbers of object 2400h, 1. */
enum capture_state {
    CAPTURE_IDLE,
    CAPTURE_FILLS,   /* what is to be there before the trigger */
    CAPTURE_WAITS,   /* for the trigger */
    CAPTURE_RECORDS, /* what comes behind it */
    CAPTURE_DONE
};

/* Where a signal stands in struct drive, and what its bits mean. */
struct capture_source {
    uint16_t offset;
    uint8_t bytes;
    uint8_t base; /* place in struct per_unit, or one of these */
};

enum { CAPTURE_COUNT = 0xff, CAPTURE_ANGLE = 0xfe };

union capture_raw {
    uint32_t count;
    num_t real;
    struct position position;
};

struct capture {
    uint32_t *memory; /* NULL: none */
    uint32_t words;

    /* what was armed; the interrupt reads it */
    const struct capture_source *source[CAPTURE_SIGNALS], *trigger;
    union capture_raw level; /* of the trigger; at once if it is NULL */
    uint32_t signals, record_words;
    uint32_t samples, before; /* in all, before the trigger */
    uint16_t divider;
    bool rises;

    /* the interrupt's */
    uint8_t state; /* enum capture_state */
    bool followed; /* the background's: control interrupts are */
    bool above, known;
    uint16_t wait;     /* interrupts until the next sample */
    uint32_t head;     /* where the next one goes; of a capture that is done, the oldest */
    uint32_t left;     /* samples until its state is over */
    uint32_t began_in; /* period of the trigger */
};

struct application;
struct link_objects;

/* Background: begins anew, as the objects say. false: they ask for what is not there. */
bool capture_arm(struct application *application, const struct link_objects *objects);

/* Background: no more interrupts are followed. */
void capture_end(struct application *application);

/* Background, once in a millisecond: of one that is done no interrupt need be followed. */
void capture_look(struct application *application);

/* Behind a control interrupt. */
void capture_follow(struct capture *capture, const struct drive *drive);

/* Background: as the interrupt has left it. */
enum capture_state capture_state_of(const struct capture *capture);

/* Of one that is done, in the units of signals.md; the oldest sample is number 0. */
double capture_value(const struct application *application, uint32_t sample, uint32_t signal);

/* The period of a sample. */
uint32_t capture_period(const struct capture *capture, uint32_t sample);

/* What the console shows: sample number `sample`; how many there are, if there is no such one. */
void capture_put(struct text *text, const struct application *application, uint32_t sample);

/* The values as one piece, REAL64, sample by sample: its bytes, and some of them. */
uint32_t capture_bytes(const struct capture *capture);
void capture_copy(const struct application *application, uint32_t offset, uint8_t *to,
                  size_t count);

#endif
