#include "firmware/link/link.h"

#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/interface/dictionary.h"
#include "firmware/link/can_bus.h"
#include "firmware/link/modbus.h"
#include "firmware/link/sdo_block.h"
#include "firmware/link/slcan.h"
#include "firmware/linkage.h"

/* Identifiers, without a node's number. */
enum { ID_NMT = 0x000, ID_HEARTBEAT = 0x700 };

enum nmt_command {
    NMT_START = 1,
    NMT_STOP = 2,
    NMT_PRE_OPERATIONAL = 0x80,
    NMT_RESET_NODE = 0x81,
    NMT_RESET_COMMUNICATION = 0x82
};

/* A silence ends what has come of a request: longer than a host's driver puts between two pieces.
 */
enum { MILLISECOND_us = 1000, LATE_us = 5000, MODBUS_SILENCE_us = 5000, ERRORS_KEPT = 4 };

/* Of the profile and our own: defaults follow as soon as communication begins. */
static void put_presets(struct link *link)
{
    objects_put_presets(&link->objects);
    link->given = 0;
    memset(&link->command, 0, sizeof link->command);
}

void link_init(struct link *link)
{
    *link = (struct link){.open = false};
    put_presets(link);
}

CALLED_FROM_OUTSIDE void link_put_memory(struct link *link, uint32_t *memory, size_t words)
{
    link->capture.memory = memory;
    link->capture.words = (uint32_t)words;
}

CALLED_FROM_OUTSIDE void link_put_can(struct link *link, const struct hal_can *can)
{
    link->can = can;
}

/* ---- frames out ---- */

bool link_has_room(const struct application *application, size_t count)
{
    const struct console *console = &application->console;

    if (application->link->on_bus) {
        return can_bus_room(application->link) >= count;
    }
    return console->answer_length + count * SLCAN_FRAME_BYTES <= sizeof console->answer;
}

static void put_text(struct application *application, const char *text)
{
    struct console *console = &application->console;

    while (*text != '\0' && console->answer_length < sizeof console->answer) {
        console->answer[console->answer_length++] = *text++;
    }
}

void link_send(struct application *application, const struct can_frame *frame)
{
    struct console *console = &application->console;

    if (application->link->on_bus) {
        can_bus_send(application->link, frame);
    } else if (!application->link->modbus && link_has_room(application, 1)) {
        console->answer_length += slcan_write(frame, &console->answer[console->answer_length]);
    }
}

static void send_state(struct application *application, uint8_t state)
{
    const struct can_frame heartbeat = {
        .id = (uint16_t)(ID_HEARTBEAT + application->link->node), .length = 1, .data = {state}};

    application->link->beaten_us = application->link->now_us;
    link_send(application, &heartbeat);
}

/* ---- errors ---- */

/* Of CiA 301: generic, and what kind of code it is; of 8xxxh a following error is the profile's. */
uint8_t link_error_register(const struct application *application)
{
    static const uint8_t kinds[16] = {[2] = 0x02, [3] = 0x04, [4] = 0x08, [5] = 0x20,
                                      [6] = 0x20, [7] = 0x20, [8] = 0x20, [15] = 0x80};
    const struct link *link = application->link;
    const unsigned of_machine = link->other_errors & (LINK_ERROR_LIMIT | LINK_ERROR_INPUT);
    const bool of_communication = link->other_errors != of_machine || link->bus_errors != 0u;
    const enum drive_fault fault = link->reported;

    return (uint8_t)((fault == DRIVE_FAULT_NONE ? 0u : 0x01u | kinds[fault_at(fault)->code >> 12]) |
                     (of_communication ? 0x11u : 0u) | (of_machine != 0u ? 0x21u : 0u));
}

static void keep_error(struct link *link, uint32_t error)
{
    struct link_objects *objects = &link->objects;

    objects->error_4 = objects->error_3;
    objects->error_3 = objects->error_2;
    objects->error_2 = objects->error_1;
    objects->error_1 = error;
    link->errors = (uint8_t)(link->errors + (link->errors < ERRORS_KEPT ? 1u : 0u));
}

/* `more`: a byte of our own behind the code, the fault by its place in faults.md. */
static void send_emergency(struct application *application, uint16_t code, uint8_t more)
{
    struct can_frame emergency = {.id = (uint16_t)application->link->objects.emergency_cob_id,
                                  .length = 8};

    can_put(emergency.data, code, 2);
    emergency.data[2] = link_error_register(application);
    emergency.data[3] = more;
    if (application->link->nmt != LINK_STOPPED &&
        (application->link->objects.emergency_cob_id & PDO_INVALID) == 0u) {
        link_send(application, &emergency);
    }
    if (code != 0u) {
        keep_error(application->link, code | (uint32_t)more << 16);
    }
}

void link_warn(struct application *application, uint16_t code)
{
    send_emergency(application, code, 0);
}

void link_begin_error(struct application *application, unsigned error, uint16_t code)
{
    struct link *link = application->link;

    if ((link->other_errors & error) == 0u) {
        link->other_errors |= (uint8_t)error;
        link_warn(application, code);
    }
}

void link_end_error(struct application *application, unsigned error)
{
    struct link *link = application->link;

    if ((link->other_errors & error) != 0u) {
        link->other_errors &= (uint8_t)~error;
        if (link_error_register(application) == 0u) {
            link_warn(application, 0);
        }
    }
}

static void report_faults(struct application *application)
{
    struct link *link = application->link;
    const enum drive_fault fault = interrupt_view_state(&application->drive) == DRIVE_FAULT
                                       ? cia402_signals(application)->fault
                                       : DRIVE_FAULT_NONE;

    if (fault != link->reported && link->nmt != LINK_STOPPED && link_has_room(application, 1)) {
        link->reported = fault;
        send_emergency(application, fault_at(fault)->code, (uint8_t)fault);
    }
}

/* ---- who commands ---- */

enum { HEARTBEAT_LOST = 0x8130, COMMUNICATION_LOST = 0x8100 };

static void lose(struct application *application, unsigned error, uint16_t code)
{
    application->link->heard = false;
    application->link->synced = false;
    link_begin_error(application, error, code);
    cia402_lose(application);
}

static void hear(struct application *application, const struct can_frame *frame)
{
    struct link *link = application->link;
    const uint32_t consumer = link->objects.consumer_heartbeat;

    if ((consumer & 0xffffu) != 0u && frame->length == 1u &&
        frame->id == ID_HEARTBEAT + (consumer >> 16 & 0x7fu)) {
        link->heard = true;
        link->heard_us = link->now_us;
        link_end_error(application, LINK_ERROR_HEARTBEAT);
    }
}

/* A SYNC may be late by half of its period, and by what a host's clock and line take anyway. */
static void watch(struct application *application)
{
    const struct link *link = application->link;
    const uint32_t heartbeat_ms = link->objects.consumer_heartbeat & 0xffffu;
    const uint32_t period_us = link->objects.sync_period_us;

    if (heartbeat_ms == 0u) {
        link_end_error(application, LINK_ERROR_HEARTBEAT);
    }
    if (period_us == 0u) {
        link_end_error(application, LINK_ERROR_SYNC);
    }
    if (link->heard && heartbeat_ms > 0u &&
        link_since(link, link->heard_us) > 1000u * heartbeat_ms) {
        lose(application, LINK_ERROR_HEARTBEAT, HEARTBEAT_LOST);
    } else if (link->synced && period_us > 0u && link->nmt == LINK_OPERATIONAL &&
               link_since(link, link->synced_us) >
                   period_us + (period_us > 2u * LATE_us ? period_us / 2u : LATE_us)) {
        lose(application, LINK_ERROR_SYNC, COMMUNICATION_LOST);
    }
}

/* ---- frames in ---- */

void link_reset_communication(struct application *application)
{
    struct link *link = application->link;

    link->node = (uint8_t)application->chosen.node_id;
    objects_put_communication(&link->objects, link->node);
    pdo_put_presets(&link->pdos, link->node);
    link->sdo.state = SDO_IDLE;
    link->nmt = LINK_PRE_OPERATIONAL;
    link->reported = DRIVE_FAULT_NONE;
    link->errors = 0;
    link->heard = false;
    link->synced = false;
    link->other_errors = 0;
    cia402_start(application);
    send_state(application, 0); /* boot-up */
}

/* Once the drive is off: settings are recalled then alone. */
static void reset_node(struct application *application)
{
    struct link *link = application->link;

    if (link->resets && interrupt_view_state(&application->drive) == DRIVE_SWITCH_ON_DISABLED) {
        link->resets = false;
        application_recall_settings(application);
        put_presets(link);
        link_reset_communication(application);
    }
}

static void obey_nmt(struct application *application, enum nmt_command command)
{
    struct link *link = application->link;

    switch (command) {
    case NMT_START:
        if (link->nmt != LINK_OPERATIONAL) {
            pdo_start(&link->pdos);
            link->synced = false; /* none was heard meanwhile */
        }
        link->nmt = LINK_OPERATIONAL;
        break;
    case NMT_STOP:
        link->nmt = LINK_STOPPED;
        link->sdo.state = SDO_IDLE;
        cia402_lose(application); /* no controlword gets through any more */
        break;
    case NMT_PRE_OPERATIONAL:
        link->nmt = LINK_PRE_OPERATIONAL;
        break;
    case NMT_RESET_NODE:
        cia402_switch_off(application); /* as soon as it rests */
        link->resets = true;
        break;
    case NMT_RESET_COMMUNICATION:
        link_reset_communication(application);
        break;
    default:
        break;
    }
}

void link_receive(struct application *application, const struct can_frame *frame)
{
    struct link *link = application->link;
    struct can_frame response;

    application_hear(application, interrupt_view_period(&application->drive));
    hear(application, frame);
    if (frame->id == ID_NMT) {
        if (frame->length == 2u && (frame->data[1] == 0u || frame->data[1] == link->node)) {
            obey_nmt(application, (enum nmt_command)frame->data[0]);
        }
    } else if (frame->id == link->objects.sdo_request) {
        if (link->nmt != LINK_STOPPED && sdo_serve(application, frame, &response)) {
            response.id = (uint16_t)link->objects.sdo_response;
            link_send(application, &response);
        }
    } else if (link->nmt == LINK_OPERATIONAL) {
        if (frame->id == (link->objects.sync_cob_id & 0x7ffu)) {
            link->synced = true;
            link->synced_us = link->now_us;
            link_end_error(application, LINK_ERROR_SYNC);
            axis_stream_sync(application);
            pdo_sync(application);
            link->axis.stream.at_sync = false;
        } else {
            pdo_receive(application, frame);
        }
    }
}

/* ---- the channel ---- */

static bool is_text(const char *line, size_t length, const char *text)
{
    return length == strlen(text) && memcmp(line, text, length) == 0;
}

/* One that is open already is another client's, which is gone. */
static void open_channel(struct application *application, bool listens_only)
{
    struct link *link = application->link;
    const bool was_open = link_has_line(link);

    if (!was_open) {
        can_bus_leave(application);
        link->open = true;
    }
    link->listens_only = listens_only && !was_open; /* what the other one has begun is braked */
    link_reset_communication(application);
    link->listens_only = listens_only;
}

/* The console goes on with what happens from now on. */
static void close_channel(struct application *application)
{
    struct link *link = application->link;

    if (link->heard || (link->synced && link->objects.sync_period_us > 0u)) {
        cia402_lose(application);
    }
    link->open = false;
    link->modbus = false;
    console_skip_announcements(application);
}

CALLED_FROM_OUTSIDE void link_open_modbus(struct application *application)
{
    application->link->modbus = true;
    application->link->byte_came = false;
    open_channel(application, false);
}

static bool obey(struct application *application, const char *line, size_t length)
{
    struct link *link = application->link;
    struct can_frame frame = {.id = 0};
    const enum slcan_meaning meaning = slcan_read(line, length, &frame);

    if (meaning == SLCAN_UNKNOWN) {
        return false;
    }
    const bool takes = link_has_line(link) && !link->listens_only;

    put_text(application, slcan_answer(meaning, takes));
    if (meaning == SLCAN_OPENS || meaning == SLCAN_LISTENS) {
        open_channel(application, meaning == SLCAN_LISTENS);
    } else if (meaning == SLCAN_CLOSES && !link->on_bus) {
        close_channel(application);
    } else if (meaning == SLCAN_SENDS && takes) {
        link_receive(application, &frame);
    }
    return true;
}

bool link_obey_line(struct application *application, const char *line, size_t length)
{
    struct link *link = application->link;

    if (link == NULL) {
        return false;
    }
    link->now_us = (uint32_t)application->board.time_us(application->board.context);
    if (is_text(line, length, "modbus")) {
        put_text(application, "ok modbus\n");
        link_open_modbus(application);
        return true;
    }
    return obey(application, line, length);
}

static bool take_character(struct application *application, char character)
{
    struct console *console = &application->console;

    if (character == '\r') {
        if (!obey(application, console->line, console->line_length) && console->line_length > 0u) {
            put_text(application, "\a");
        }
        console->line_length = 0;
    } else if (character != '\n' && console->line_length <= SLCAN_LINE_BYTES) {
        console->line[console->line_length++] = character;
    }
    return character == '\r';
}

/* ---- Modbus ---- */

static void serve_modbus(struct application *application)
{
    struct console *console = &application->console;
    uint8_t *response = (uint8_t *)&console->answer[console->answer_length];

    if (console->answer_length + MODBUS_RESPONSE_BYTES <= sizeof console->answer) {
        console->answer_length +=
            modbus_serve(application, application->link->node, (const uint8_t *)console->line,
                         console->line_length, response);
    }
    console->line_length = 0;
}

static bool take_modbus(struct application *application, char byte)
{
    struct console *console = &application->console;

    application->link->byte_came = true;
    if (console->line_length < MODBUS_REQUEST_BYTES) {
        console->line[console->line_length++] = byte;
    }
    if (!modbus_is_whole((const uint8_t *)console->line, console->line_length)) {
        return false;
    }
    serve_modbus(application);
    return true;
}

/* What has come is all of it where nothing follows. */
static void end_modbus_request(struct application *application)
{
    struct link *link = application->link;
    struct console *console = &application->console;

    if (link->byte_came) {
        link->byte_came = false;
        link->byte_us = link->now_us;
    } else if (console->line_length > 0u && link_since(link, link->byte_us) >= MODBUS_SILENCE_us) {
        if (is_text(console->line, console->line_length, "C\r")) {
            close_channel(application);
        } else {
            serve_modbus(application);
        }
        console->line_length = 0;
    }
}

bool link_take(struct application *application, char byte)
{
    return application->link->modbus ? take_modbus(application, byte)
                                     : take_character(application, byte);
}

void link_beside_console(struct application *application)
{
    struct link *link = application->link;

    if (link->can != NULL) {
        link->now_us = (uint32_t)application->board.time_us(application->board.context);
    }
    if (link->on_bus) {
        can_bus_background(application);
    } else if (link->axis.lost) {
        cia402_background(application);
        reset_node(application);
    } else if (link->can != NULL) {
        can_bus_join(application);
    }
}

void link_background(struct application *application)
{
    struct link *link = application->link;

    link->now_us = (uint32_t)application->board.time_us(application->board.context);
    if (link->modbus) {
        end_modbus_request(application);
    }
    cia402_background(application);
    reset_node(application);
    sdo_block_send(application);
    if (link_since(link, link->looked_us) < MILLISECOND_us) {
        return;
    }
    link->looked_us = link->now_us;
    cia402_look(application);
    capture_look(application);
    watch(application);
    if (link->on_bus) {
        can_bus_watch(application);
    }
    report_faults(application);
    if (link->nmt == LINK_OPERATIONAL) {
        pdo_look(application);
    }
    if (link->objects.heartbeat_ms > 0u &&
        link_since(link, link->beaten_us) >= 1000u * link->objects.heartbeat_ms) {
        send_state(application, link->nmt);
    }
}
