#include "firmware/link/can_bus.h"

#include "firmware/application/application.h"
#include "firmware/link/link.h"

enum { OVERRUN = 0x8110, ERROR_PASSIVE = 0x8120, RECOVERED = 0x8140 };

enum { ID_HEARTBEAT = 0x700, ID_BITS = 0x7ff, SECOND_us = 1000000 };

/* Network management, SYNC, the SDO server's requests, the master's heartbeat, what PDOs bring. */
static void accept_ours(const struct link *link)
{
    uint16_t ids[HAL_CAN_IDS] = {
        [1] = (uint16_t)(link->objects.sync_cob_id & ID_BITS),
        [2] = (uint16_t)link->objects.sdo_request,
        [3] = (uint16_t)(ID_HEARTBEAT + (link->objects.consumer_heartbeat >> 16 & 0x7fu)),
    };

    for (size_t i = 0; i < PDOS; i++) {
        const uint32_t cob_id = link->pdos.received[i].cob_id;

        ids[4u + i] = (uint16_t)((cob_id & PDO_INVALID) != 0u ? 0u : cob_id & ID_BITS);
    }
    link->can->accept(link->can->context, ids);
}

void can_bus_join(struct application *application)
{
    struct link *link = application->link;
    struct cia402 *axis = &link->axis;
    struct can_frame old;

    while (link->can->receive(link->can->context, &old)) { /* from before it left */
    }
    link->open = true;
    link->on_bus = true;
    link->bus_errors = 0;
    link->overrun_us = link->now_us - SECOND_us;
    link->listens_only = true; /* for as long as it begins: nothing is braked */
    link_reset_communication(application);
    link->listens_only = false;
    if (axis->state == CIA402_SWITCHED_ON) {
        axis->state = CIA402_SWITCH_ON_DISABLED;
        axis->controlword = 0;
    }
    accept_ours(link);
}

void can_bus_leave(struct application *application)
{
    struct link *link = application->link;

    if (link->on_bus) {
        cia402_lose(application);
        link->on_bus = false;
        link->bus_errors = 0;
        link->can->accept(link->can->context, NULL);
    }
}

void can_bus_background(struct application *application)
{
    const struct hal_can *can = application->link->can;
    struct can_frame frame;

    if (can->receive(can->context, &frame)) {
        link_receive(application, &frame);
    }
    link_background(application);
}

/* Whoever commands the drive is cut off for as long as the bus is. */
void can_bus_watch(struct application *application)
{
    struct link *link = application->link;
    const uint32_t state = link->can->state(link->can->context);
    const uint32_t errors = state & (HAL_CAN_PASSIVE | HAL_CAN_OFF);
    const uint32_t begun = errors & ~link->bus_errors;
    const uint32_t ended = link->bus_errors & ~errors;

    if ((begun & HAL_CAN_OFF) != 0u) {
        cia402_lose(application);
    }
    if ((ended & HAL_CAN_OFF) != 0u) {
        link_warn(application, RECOVERED);
    }
    link->bus_errors = errors;
    if (begun == HAL_CAN_PASSIVE) {
        link_warn(application, ERROR_PASSIVE);
    } else if (ended != 0u && link_error_register(application) == 0u) {
        link_warn(application, 0);
    }
    if ((state & HAL_CAN_LOST) != 0u && link_since(link, link->overrun_us) >= SECOND_us) {
        link->overrun_us = link->now_us;
        link_warn(application, OVERRUN);
    }
    accept_ours(link);
}

size_t can_bus_room(const struct link *link)
{
    return link->can->room(link->can->context);
}

void can_bus_send(const struct link *link, const struct can_frame *frame)
{
    link->can->send(link->can->context, frame);
}
