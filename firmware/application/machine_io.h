/*
 * The machine around the drive, on wires: switches that it obeys and what it reports to a
 * controller that has no bus. Looked at once in a millisecond, in the background; a level counts
 * when two looks have found it.
 *
 *   limit -, limit +   what moves towards it is braked, and refused from then on; back is allowed
 *   home               is only shown (60fdh)
 *   enable             without it nothing is enabled; where it goes the drive stops, then is off
 *   quick stop         stops, and refuses to move; on a fieldbus as 605ah has it
 *
 *   alarm              a fault has opened the bridge
 *   in position        the reference rests, and the rotor is within 0.01 rad of it
 *   brake              a holding brake is released, once a current holds the rotor; it engages
 *                      holding_brake_s before a `disable` takes the current away, and at once
 *                      with a fault
 *
 * Which inputs there are and which levels are active: settings inputs_used, inputs_low,
 * outputs_low.
 */
#ifndef STEADYSTEP_MACHINE_IO_H
#define STEADYSTEP_MACHINE_IO_H

#include "firmware/interface/drive_interface.h"
#include "firmware/interface/parts_carried.h"
#include "hal/hal.h"

struct application;

/* Why the drive has stopped by itself. */
enum machine_stop {
    MACHINE_STOP_NONE,
    MACHINE_STOP_LIMIT_MINUS,
    MACHINE_STOP_LIMIT_PLUS,
    MACHINE_STOP_QUICK,
    MACHINE_STOP_NOT_ENABLED
};

struct machine_io {
    uint32_t looked_in; /* period of the last look */
    uint8_t seen;       /* levels of the last look, HAL_INPUT_... */
    uint8_t levels;     /* as two looks have found them */
    uint8_t outputs;    /* HAL_OUTPUT_..., active */
    uint8_t stop;       /* enum machine_stop: while it lasts */
    bool engages;       /* the brake, before the bridge is off */
};

/* What is set is for a board that has it; false: reason in error. At its start levels are as they
   are found. */
bool machine_io_start(struct application *application, bool starts, char error[DRIVE_ERROR_TEXT]);

/* Of the inputs that are wired those that are active, HAL_INPUT_... */
uint32_t machine_io_active(const struct application *application);

/* Those that the last look has found active, whether or not the one before has, too. */
uint32_t machine_io_seen(const struct application *application);

/* Background, all the time. */
void machine_io_background(struct application *application);

/* Whether the inputs allow the command; false: reason in error. A `disable` is put off until the
   brake holds. */
bool machine_io_allows(struct application *application, struct drive_command *command,
                       char error[DRIVE_ERROR_TEXT]);

/* "limit switch + ..." */
const char *machine_stop_text(enum machine_stop stop);

#endif
