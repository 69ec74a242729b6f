/* The objects of CiA 402 that code answers for. */
#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/axis_torque.h"
#include "firmware/link/link.h"

/* Bits of the statusword. */
enum { VOLTAGE_ENABLED = 0x0010, WARNING = 0x0080, REMOTE = 0x0200, REACHED = 0x0400 };

/* Modes of operation, a bit each from 1 on. */
enum {
    MODES = 1 << (CIA402_PROFILE_POSITION - 1) | 1 << (CIA402_PROFILE_VELOCITY - 1) |
            1 << (CIA402_HOMING - 1) | 1 << (CIA402_CYCLIC_POSITION - 1),
    MODE_OF_TORQUE = 1 << (CIA402_CYCLIC_TORQUE - 1)
};

static uint16_t statusword(struct application *application)
{
    const struct cia402 *axis = &application->link->axis;
    const enum drive_state drive = interrupt_view_state(&application->drive);
    const bool doubtful = interrupt_view_synchronism(&application->drive) != DRIVE_SYNCHRONISM_SURE;
    uint16_t status = axis->state | REMOTE;

    status |= drive != DRIVE_SWITCH_ON_DISABLED && drive != DRIVE_FAULT ? VOLTAGE_ENABLED : 0u;
    status |= axis->refused || (axis->state == CIA402_OPERATION_ENABLED && doubtful) ? WARNING : 0u;
    if (axis->state == CIA402_OPERATION_ENABLED) {
        status |= axis_motion_status(application);
    } else if (axis->state == CIA402_QUICK_STOP_ACTIVE && axis_motion_rests(application)) {
        status |= REACHED;
    }
    return status;
}

double cia402_unit_rad(const struct link_objects *objects)
{
    return 6.283185307179586 * (double)objects->feed_shaft * (double)objects->gear_motor /
           ((double)objects->feed * (double)objects->gear_shaft);
}

double cia402_turned_unit_rad(const struct link_objects *objects, uint8_t turned)
{
    const double unit_rad = cia402_unit_rad(objects);

    return (objects->polarity & turned) != 0u ? -unit_rad : unit_rad;
}

/* A whole number of 32 bits, rounded; the nearest one where it is beyond. */
static int32_t rounded(double value)
{
    if (value >= 2147483647.0) {
        return INT32_MAX;
    }
    if (value <= -2147483648.0) {
        return INT32_MIN;
    }
    return (int32_t)(value < 0.0 ? value - 0.5 : value + 0.5);
}

double cia402_wraps(double units)
{
    const double range = 4294967296.0;

    return range * (double)rounded(units / range);
}

/* Of the motor: mA, mN m; what it makes of them, in thousandths; mV. */
static double rated_share(struct application *application, uint16_t index)
{
    const struct drive_signals *now = cia402_signals(application);
    const struct drive_settings *settings = &application->drive.settings;
    const double rated_A = settings->motor.rated_current_A;

    switch (index) {
    case 0x6072:
        return 1e3 * settings->current_limit_A / rated_A;
    case 0x6074:
        return 1e3 * now->i_q_ref_A / rated_A;
    case 0x6075:
        return 1e3 * rated_A;
    case 0x6076:
        return 1e3 * rated_A * settings->motor.torque_constant_Nm_A;
    case 0x6077: /* the hold's is not measured */
    case 0x6078:
        return 1e3 * now->i_q_A / rated_A;
    default:
        return 1e3 * now->bus_V;
    }
}

int32_t cia402_thousandths(struct application *application, uint16_t index)
{
    return rounded(rated_share(application, index));
}

/* In units; of those that are measured in them. */
static double quantity(struct application *application, uint16_t index)
{
    const struct drive_signals *now = cia402_signals(application);
    uint8_t turned = CIA402_POSITION_TURNED;
    double value;

    switch (index) {
    case 0x6062:
        value = now->theta_ref_rad;
        break;
    case 0x6064:
        value = now->theta_est_rad;
        break;
    case 0x606b:
        value = now->omega_ref_rad_s;
        turned = CIA402_VELOCITY_TURNED;
        break;
    case 0x606c:
        value = now->omega_est_rad_s;
        turned = CIA402_VELOCITY_TURNED;
        break;
    case 0x60f4:
        value = now->theta_ref_rad - now->theta_est_rad;
        break;
    default:
        return rated_share(application, index);
    }
    value /= cia402_turned_unit_rad(&application->link->objects, turned);
    return turned == CIA402_POSITION_TURNED ? value - cia402_wraps(value) : value;
}

/* Bits of 60fdh: the inputs, quick stop as the first of our own; of 60feh: "set brake", alarm, in
   position. */
static uint32_t wires(const struct application *application, uint16_t index)
{
    const struct machine_io *io = &application->io;
    const uint32_t inputs = machine_io_active(application);

    if (index == 0x60fdu) {
        return (inputs & 0x0fu) | ((inputs & HAL_INPUT_QUICK_STOP) != 0u ? 1u << 16 : 0u);
    }
    return ((io->outputs & HAL_OUTPUT_BRAKE) == 0u ? 1u : 0u) |
           (uint32_t)(io->outputs & (HAL_OUTPUT_ALARM | HAL_OUTPUT_IN_POSITION)) << 16;
}

void cia402_ask(struct application *application, const struct object *object, uint8_t *value)
{
    const struct cia402 *axis = &application->link->axis;

    switch (object->index) {
    case 0x6040:
        can_put(value, axis->controlword, 2);
        break;
    case 0x6041:
        can_put(value, statusword(application), 2);
        break;
    case 0x6061:
        can_put(value, (uint8_t)axis->mode, 1);
        break;
    case 0x6502:
        can_put(value, MODES | (axis_torque_is_carried(application) ? MODE_OF_TORQUE : 0u), 4);
        break;
    case 0x60fd:
    case 0x60fe:
        can_put(value, wires(application, object->index), 4);
        break;
    default:
        can_put(value, (uint32_t)rounded(quantity(application, object->index)),
                object_bytes(object));
        break;
    }
}
