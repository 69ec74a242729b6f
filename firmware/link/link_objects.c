/* The objects of CiA 301 that code answers for, and what may become of those that are stored. */
#include "firmware/application/application.h"
#include "firmware/application/setting_change.h"
#include "firmware/link/axis_homing.h"
#include "firmware/link/axis_motion.h"
#include "firmware/link/axis_torque.h"
#include "firmware/link/data_sheet.h"
#include "firmware/link/link.h"

enum { CURRENT_LIMIT = 0x2120 }; /* its setting */

enum { SAVE = 0x65766173, LOAD = 0x64616f6c }; /* "save", "load" */

static uint32_t capture_shown(const struct capture *capture, uint8_t sub)
{
    const enum capture_state state = capture_state_of(capture);

    return sub == 1u               ? state
           : state != CAPTURE_DONE ? 0u
           : sub == 8u             ? capture->samples
                                   : capture_period(capture, 0);
}

enum object_abort link_ask(struct application *application, const struct object *object,
                           uint8_t value[OBJECT_BYTES_MAX], const char **text)
{
    switch (object->index) {
    case 0x1001:
        value[0] = link_error_register(application);
        break;
    case 0x1003:
        value[0] = application->link->errors;
        break;
    case 0x1008:
        *text = application->facts.board_name;
        break;
    case 0x100a:
        *text = application->board.version;
        break;
    case 0x1010:
    case 0x1011:
        can_put(value, 1, 4); /* on command */
        break;
    case OBJECT_DATA_SHEET:
        *text = data_sheet;
        break;
    case 0x1022: /* how it is stored: as text */
        value[0] = 0;
        break;
    case 0x2400:
        can_put(value, capture_shown(&application->link->capture, object->sub),
                object_bytes(object));
        break;
    case 0x60e3:
        value[0] = object->sub == 0u ? axis_homing_methods(application)
                                     : (uint8_t)axis_homing_method(object->sub);
        break;
    case 0x2402: /* sdo.h asks for it itself */
        break;
    default:
        if (object->index < 0x2000u) {
            pdo_ask(&application->link->pdos, object, value);
        } else {
            cia402_ask(application, object, value);
        }
        break;
    }
    return OBJECT_DONE;
}

/* What is restored is what the next reset finds, too. */
static enum object_abort store(struct application *application, bool restores, uint32_t signature)
{
    char refusal[DRIVE_ERROR_TEXT];

    if (signature != (restores ? LOAD : SAVE)) {
        return OBJECT_NOT_TRANSFERRED;
    }
    if (restores && !settings_restore(application, refusal)) {
        return OBJECT_WRONG_STATE;
    }
    return settings_store(application, refusal) == RECORD_REFUSED ? OBJECT_STORE_FAILED
                                                                  : OBJECT_DONE;
}

/* The current limit, in thousandths of the rated current: torque goes with it. */
static enum object_abort limit_torque(struct application *application, uint32_t thousandths)
{
    const double limit_A =
        1e-3 * (double)thousandths * application->drive.settings.motor.rated_current_A;
    char refusal[DRIVE_ERROR_TEXT];
    const enum setting_change change =
        setting_change(application, setting_of_index(CURRENT_LIMIT), 0, limit_A, refusal);

    return change == SETTING_CHANGED        ? OBJECT_DONE
           : change == SETTING_OUT_OF_RANGE ? OBJECT_OUT_OF_RANGE
                                            : OBJECT_WRONG_STATE;
}

/* 1: begins, 0: ends. */
static enum object_abort command_capture(struct application *application, uint8_t number)
{
    if (number == 1u) {
        return capture_arm(application, &application->link->objects) ? OBJECT_DONE
                                                                     : OBJECT_WRONG_STATE;
    }
    capture_end(application);
    return number == 0u ? OBJECT_DONE : OBJECT_OUT_OF_RANGE;
}

enum object_abort link_obey(struct application *application, const struct object *object,
                            const uint8_t value[OBJECT_BYTES_MAX])
{
    switch (object->index) {
    case 0x1003:
        if (value[0] != 0u) {
            return OBJECT_OUT_OF_RANGE;
        }
        application->link->errors = 0;
        return OBJECT_DONE;
    case 0x1010:
    case 0x1011:
        return store(application, object->index == 0x1011u, can_get(value, 4));
    case 0x6072:
        return limit_torque(application, can_get(value, 2));
    case 0x2400:
        return command_capture(application, value[0]);
    case 0x6040:
        cia402_control(application, (uint16_t)can_get(value, 2));
        return OBJECT_DONE;
    default:
        return pdo_obey(application, object, value);
    }
}

static bool is_mode(const struct application *application, int8_t mode)
{
    return mode == CIA402_PROFILE_POSITION || mode == CIA402_PROFILE_VELOCITY ||
           mode == CIA402_HOMING || mode == CIA402_CYCLIC_POSITION || mode == 0 ||
           (mode == CIA402_CYCLIC_TORQUE && axis_torque_is_carried(application));
}

static bool accepts_of_capture(uint8_t sub, const uint8_t *value)
{
    double level;

    memcpy(&level, value, sizeof level);
    return sub == 2u   ? (value[0] | value[1]) != 0
           : sub == 4u ? level == level
                       : sub != 5u || value[0] == 1u || value[0] == UINT8_MAX;
}

bool link_accepts(const struct application *application, const struct object *object,
                  const uint8_t value[OBJECT_BYTES_MAX])
{
    const uint32_t number = can_get(value, object_bytes(object));

    switch (object->index) {
    case 0x1005:
        /* bit 31 means nothing; it makes none, and has no identifiers of 29 bits */
        return pdo_may_have(number & ~PDO_INVALID);
    case 0x1014:
        return pdo_may_become(application->link->objects.emergency_cob_id, number);
    case 0x1016:
        return number >> 16 <= 127u;
    case 0x2400:
        return accepts_of_capture(object->sub, value);
    case 0x2403:
        return number != 0u;
    case 0x6060:
        return is_mode(application, (int8_t)value[0]);
    case 0x6098:
        return axis_homing_is_method((int8_t)value[0]);
    case 0x60c2:
        return object->sub == 1u ? number != 0u : (int8_t)value[0] >= -6 && (int8_t)value[0] <= 0;
    case 0x605a:
        return number <= 2u || number == 5u || number == 6u;
    case 0x605d:
        return number == 1u || number == 2u;
    case 0x607d:
        return object->sub == 1u ? (int32_t)number <= application->link->objects.position_most
                                 : (int32_t)number >= application->link->objects.position_least;
    case 0x607e: /* the others have no meaning */
        return (number & 0x3fu) == 0u && axis_motion_is_free(application);
    case 0x6091:
    case 0x6092:
        return number != 0u && axis_motion_is_free(application);
    case 0x6080:
    case 0x6081:
    case 0x6083:
    case 0x6084:
    case 0x6085:
    case 0x6099:
    case 0x609a:
        return number != 0u;
    default:
        return true;
    }
}

/* What is supervised anew has not come yet. */
void link_has_put(struct application *application, const struct object *object)
{
    switch (object->index) {
    case 0x1006:
        application->link->synced = false;
        break;
    case 0x1016:
        application->link->heard = false;
        break;
    case 0x6091:
    case 0x6092:
        axis_motion_put_defaults(application);
        break;
    case 0x607a:
        axis_motion_cycle(application);
        break;
    default:
        axis_motion_note_given(application, object->at);
        break;
    }
}
