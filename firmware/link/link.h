/*
 * The drive as a CANopen node of the profile for drives: CiA 301 and 402, carried by the board's
 * CAN bus, or as text frames (slcan.h) by its serial line. While the line's channel is open, from
 * the line "O" to "C", the console is silent and the line carries frames alone; what the drive does
 * goes on when it closes. For so long the node is off its bus (can_bus.h).
 *
 * Or as a server of Modbus RTU on the same dictionary, from the line "modbus" on, or from power-up.
 *
 * A slave: NMT, heartbeat, emergencies, SYNC, one SDO server (sdo.h), four PDOs each way (pdo.h),
 * and the drive profile (cia402.h). All of it runs in the background, as the console does.
 */
#ifndef STEADYSTEP_LINK_H
#define STEADYSTEP_LINK_H

#include "firmware/interface/drive_interface.h"
#include "firmware/link/can_frame.h"
#include "firmware/link/capture.h"
#include "firmware/link/cia402.h"
#include "firmware/link/objects.h"
#include "firmware/link/pdo.h"
#include "firmware/link/sdo.h"

/* States of the node, by the numbers of its heartbeat. */
enum link_nmt { LINK_STOPPED = 0x04, LINK_OPERATIONAL = 0x05, LINK_PRE_OPERATIONAL = 0x7f };

struct application;

struct link {
    bool open;                 /* a channel is: the line's, or the bus */
    bool on_bus;               /* the bus: the line is the console's */
    bool heard;                /* the heartbeat that 1016h names, at least once */
    bool synced;               /* SYNC has come, at least once */
    uint8_t other_errors;      /* which last, in bits: emergencies have said so */
    bool listens_only;         /* the client does: it sends nothing */
    bool modbus;               /* the line carries Modbus RTU (modbus.h), not frames */
    bool byte_came;            /* of Modbus, in this pass */
    bool resets;               /* the node, when the drive is off */
    uint8_t node;              /* its number: the setting's when communication began */
    uint8_t nmt;               /* enum link_nmt */
    uint8_t errors;            /* in the field 1003h */
    uint16_t given;            /* of the objects with a default of the motor's, in bits */
    enum drive_fault reported; /* by an emergency */
    uint32_t now_us;           /* of this pass; wraps */
    uint32_t beaten_us;        /* last heartbeat */
    uint32_t looked_us;        /* last millisecond's look */
    uint32_t heard_us, synced_us;
    uint32_t byte_us; /* last byte of Modbus */
    struct link_objects objects;
    struct sdo_server sdo;
    struct pdos pdos;
    struct cia402 axis;
    struct capture capture;
    struct drive_command command; /* parameters put by 2201h and on, for 2200h */
    const struct hal_can *can;    /* NULL: the board has no bus */
    uint32_t bus_errors;          /* HAL_CAN_..., as emergencies have said */
    uint32_t overrun_us;          /* the last emergency that said so */
};

/* Before the first pass: closed. */
void link_init(struct link *link);

/* Behind it: so much memory for the capture, of a board that follows the control (hal.h). */
void link_put_memory(struct link *link, uint32_t *memory, size_t words);

/* Behind it: a board's CAN bus, where the node lives from the first pass on. */
void link_put_can(struct link *link, const struct hal_can *can);

/* Whether the serial line carries the link, and not the console. */
static inline bool link_has_line(const struct link *link)
{
    return link->open && !link->on_bus;
}

/* The line carries Modbus RTU from now on, until the two bytes "C\r" stand alone in it. */
void link_open_modbus(struct application *application);

/* The console, closed: obeys the line if it is "modbus" or one of slcan. false: it is none. */
bool link_obey_line(struct application *application, const char *line, size_t length);

/* A byte that has come while the line has the channel. true: it ends a frame. */
bool link_take(struct application *application, char byte);

/* Background, while the channel is open: what nobody asked for, and what time brings. */
void link_background(struct application *application);

/* Background, while the line is the console's: the bus; without one, what the drive was in the
   midst of when the channel closed, a quick stop, ends. */
void link_beside_console(struct application *application);

/* A frame from the bus. */
void link_receive(struct application *application, const struct can_frame *frame);

/* Communication begins, as after a reset of it. */
void link_reset_communication(struct application *application);

/* Whether so many more frames fit into what is being sent. */
bool link_has_room(const struct application *application, size_t count);

/* Errors that are no fault of the drive, in bits: of communication, from LINK_ERROR_OF_PDO on one
   for each PDO that is received; of the machine's switches. */
enum {
    LINK_ERROR_HEARTBEAT = 1,
    LINK_ERROR_SYNC = 2,
    LINK_ERROR_OF_PDO = 4,
    LINK_ERROR_LIMIT = LINK_ERROR_OF_PDO << PDOS, /* a limit switch */
    LINK_ERROR_INPUT = LINK_ERROR_LIMIT << 1      /* quick stop or enable */
};

/* One of them is there, or not: an emergency of this code when it begins, and one of code 0 when
   none is left. */
void link_begin_error(struct application *application, unsigned error, uint16_t code);
void link_end_error(struct application *application, unsigned error);

/* An emergency that says no fault of the drive, and passes. */
void link_warn(struct application *application, uint16_t code);

/* A frame to the bus; lost if none fits. */
void link_send(struct application *application, const struct can_frame *frame);

/* Of objects that code answers for (objects.h). */
enum object_abort link_ask(struct application *application, const struct object *object,
                           uint8_t value[OBJECT_BYTES_MAX], const char **text);
enum object_abort link_obey(struct application *application, const struct object *object,
                            const uint8_t value[OBJECT_BYTES_MAX]);

/* Whether a member of struct link_objects may become so. */
bool link_accepts(const struct application *application, const struct object *object,
                  const uint8_t value[OBJECT_BYTES_MAX]);

/* A member of struct link_objects has become so. */
void link_has_put(struct application *application, const struct object *object);

/* The error register: which kinds of error there are. */
uint8_t link_error_register(const struct application *application);

/* Microseconds since a time that has passed, less than half an hour ago. */
static inline uint32_t link_since(const struct link *link, uint32_t then_us)
{
    return link->now_us - then_us;
}

#endif
