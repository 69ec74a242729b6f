#include "firmware/link/objects.h"

#include "firmware/application/application.h"
#include "firmware/application/setting_change.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/interface/dictionary.h"
#include "firmware/link/link.h"

struct object_row {
    uint16_t index;
    uint16_t at; /* OBJECT_ASKED_AT: code answers for it */
    uint8_t sub;
    uint8_t type;
    uint8_t access;
};

enum { OBJECT_ASKED_AT = UINT16_MAX };

#define STORED_ROW(index, sub, type, access, member, preset, name)                                 \
    {index, offsetof(struct link_objects, member), sub, OBJECT_##type, OBJECT_##access},
#define ASKED_ROW(index, sub, type, access, preset, name)                                          \
    {index, OBJECT_ASKED_AT, sub, OBJECT_##type, OBJECT_##access},
#define STORED_PRESET(index, sub, type, access, member, preset, name) .member = (preset),

static const struct object_row rows[] = {LINK_OBJECTS(STORED_ROW, ASKED_ROW)};
static const struct link_objects presets = {LINK_OBJECTS(STORED_PRESET, OBJECT_NONE)};

enum { ROWS = sizeof rows / sizeof rows[0] };

#define PARAMETER_OBJECT(index, member, unit, least, most, sentence)                               \
    {index, offsetof(struct drive_command, member)},

static const struct {
    uint16_t index, at;
} parameters[] = {DRIVE_PARAMETERS_TABLE(PARAMETER_OBJECT)};

enum { COMMAND_INDEX = 0x2200 };

void objects_put_presets(struct link_objects *objects)
{
    *objects = presets;
}

/* Members lie in the rows' order; counts of sub-indexes, behind all others, never change. */
void objects_put_communication(struct link_objects *objects, uint8_t node)
{
    memcpy(objects, &presets, offsetof(struct link_objects, capture_divider));
    objects->emergency_cob_id += node;
    objects->sdo_request += node;
    objects->sdo_response += node;
}

/* Of the PDOs, whose rows are those of the first: four of a kind, and eight entries of a mapping.
 */
static bool is_of_pdo(uint16_t index)
{
    return index >= 0x1400u && index < 0x1c00u && (index & 0x1fcu) == 0u;
}

static bool find_row(uint16_t index, uint8_t sub, struct object *found, bool *sub_missing)
{
    const uint16_t of_rows = is_of_pdo(index) ? index & 0xfffcu : index;
    const uint8_t sub_of_rows = sub > 1u && sub <= LINK_OBJECT_ENTRIES(index, 1u) ? 1 : sub;

    for (const struct object_row *row = rows; row != rows + ROWS; row++) {
        if (row->index == of_rows && row->sub == sub_of_rows) {
            found->kind = row->at == OBJECT_ASKED_AT ? OBJECT_ASKED : OBJECT_STORED;
            found->type = row->type;
            found->access = row->access;
            found->at = row->at;
            return true;
        }
        *sub_missing = *sub_missing || row->index == of_rows;
    }
    return false;
}

static bool find_setting(uint16_t index, struct object *found)
{
    static const uint8_t types[] = {OBJECT_U8, OBJECT_BOOLEAN, OBJECT_REAL64, OBJECT_I32};

    found->setting = setting_of_index(index);
    if (found->setting == NULL) {
        return false;
    }
    found->kind = OBJECT_SETTING;
    found->type = types[found->setting->type];
    found->access = OBJECT_RW;
    found->at = (uint16_t)(index - found->setting->index);
    return true;
}

static bool find_signal(uint16_t index, struct object *found)
{
    for (int i = 0; i < SIGNALS; i++) {
        const struct signal_row *row = signal_at((enum drive_signal)i);

        if (row->index == index) {
            found->kind = OBJECT_SIGNAL;
            found->at = (uint16_t)i;
            found->access = OBJECT_RO_T;
            found->type = i == SIGNAL_fault           ? OBJECT_U16
                          : row->type == SIGNAL_FLAG  ? OBJECT_BOOLEAN
                          : row->type == SIGNAL_COUNT ? OBJECT_U32
                          : row->type == SIGNAL_REAL  ? OBJECT_REAL64
                                                      : OBJECT_U8;
            return true;
        }
    }
    return false;
}

static bool find_command(uint16_t index, struct object *found)
{
    if (index == COMMAND_INDEX) {
        found->kind = OBJECT_COMMAND;
        found->type = OBJECT_U8;
        found->access = OBJECT_WO;
        return true;
    }
    for (size_t i = 0; i < DRIVE_PARAMETERS; i++) {
        if (parameters[i].index == index) {
            found->kind = OBJECT_PARAMETER;
            found->type = OBJECT_REAL64;
            found->access = OBJECT_RW;
            found->at = parameters[i].at;
            return true;
        }
    }
    return false;
}

enum object_abort objects_find(uint16_t index, uint8_t sub, struct object *found)
{
    bool sub_missing = false;

    *found = (struct object){.index = index, .sub = sub};
    if (find_row(index, sub, found, &sub_missing)) {
        return OBJECT_DONE;
    }
    if (sub_missing) {
        return OBJECT_SUB_MISSING;
    }
    if (!find_setting(index, found) && !find_signal(index, found) && !find_command(index, found)) {
        return OBJECT_MISSING;
    }
    return sub == 0u ? OBJECT_DONE : OBJECT_SUB_MISSING;
}

size_t object_bytes(const struct object *object)
{
    switch (object->type) {
    case OBJECT_BOOLEAN:
    case OBJECT_I8:
    case OBJECT_U8:
        return 1;
    case OBJECT_I16:
    case OBJECT_U16:
        return 2;
    case OBJECT_I32:
    case OBJECT_U32:
        return 4;
    case OBJECT_REAL64:
        return 8;
    default:
        return 0;
    }
}

/* ---- numbers ---- */

static void put_number(const struct object *object, double number, uint8_t value[OBJECT_BYTES_MAX])
{
    if (object->type == OBJECT_REAL64) {
        memcpy(value, &number, sizeof number);
    } else if (object->type == OBJECT_I32) {
        can_put(value, (uint32_t)(int32_t)number, 4);
    } else {
        can_put(value, (uint32_t)number, object_bytes(object));
    }
}

static double number_of(const struct object *object, const uint8_t value[OBJECT_BYTES_MAX])
{
    double number;

    if (object->type == OBJECT_REAL64) {
        memcpy(&number, value, sizeof number);
        return number;
    }
    const uint32_t whole = can_get(value, object_bytes(object));

    return object->type == OBJECT_I32 ? (double)(int32_t)whole : (double)whole;
}

/* What is not given shows what has followed, as the console does. */
static double setting_shown(const struct application *application, const struct object *object)
{
    const double chosen = setting_get(&application->chosen, object->setting, object->at);

    return chosen == chosen
               ? chosen
               : setting_get(&application->drive.settings, object->setting, object->at);
}

static double signal_shown(struct application *application, const struct object *object)
{
    const struct signal_row *row = signal_at((enum drive_signal)object->at);
    const double shown = signal_get(cia402_signals(application), row);

    return object->at == SIGNAL_fault ? fault_at((enum drive_fault)(int)shown)->code : shown;
}

/* ---- access ---- */

enum object_abort object_get(struct application *application, const struct object *object,
                             uint8_t value[OBJECT_BYTES_MAX], const char **text)
{
    struct link *link = application->link;

    if ((object->access & OBJECT_READ) == 0u) {
        return OBJECT_WRITE_ONLY;
    }
    switch (object->kind) {
    case OBJECT_STORED:
        if (object->index == 0x1003u && object->sub > link->errors) {
            return OBJECT_NO_DATA;
        }
        memcpy(value, (const uint8_t *)&link->objects + object->at, object_bytes(object));
        return OBJECT_DONE;
    case OBJECT_SETTING:
        put_number(object, setting_shown(application, object), value);
        return OBJECT_DONE;
    case OBJECT_SIGNAL:
        put_number(object, signal_shown(application, object), value);
        return OBJECT_DONE;
    case OBJECT_PARAMETER:
        memcpy(value, (const uint8_t *)&link->command + object->at, sizeof(double));
        return OBJECT_DONE;
    default:
        return link_ask(application, object, value, text);
    }
}

static enum object_abort put_setting(struct application *application, const struct object *object,
                                     double number)
{
    char refusal[DRIVE_ERROR_TEXT];
    const enum setting_change change =
        setting_change(application, object->setting, object->at, number, refusal);

    return change == SETTING_CHANGED        ? OBJECT_DONE
           : change == SETTING_OUT_OF_RANGE ? OBJECT_OUT_OF_RANGE
                                            : OBJECT_WRONG_STATE;
}

/* A command by its number, with the parameters that were put before. */
static enum object_abort put_command(struct application *application, unsigned number)
{
    struct drive_command *command = &application->link->command;
    char refusal[DRIVE_ERROR_TEXT];

    if (number < 1u || number > DRIVE_COMMANDS) {
        return OBJECT_OUT_OF_RANGE;
    }
    command->kind = (enum drive_command_kind)(number - 1u);
    command->at_period = interrupt_view_period(&application->drive);
    return application_command(application, command, command->at_period, refusal)
               ? OBJECT_DONE
               : OBJECT_WRONG_STATE;
}

enum object_abort object_put(struct application *application, const struct object *object,
                             const uint8_t value[OBJECT_BYTES_MAX])
{
    struct link *link = application->link;

    if ((object->access & OBJECT_WRITE) == 0u) {
        return OBJECT_READ_ONLY;
    }
    switch (object->kind) {
    case OBJECT_STORED:
        if (!link_accepts(application, object, value)) {
            return OBJECT_OUT_OF_RANGE;
        }
        memcpy((uint8_t *)&link->objects + object->at, value, object_bytes(object));
        link_has_put(application, object);
        return OBJECT_DONE;
    case OBJECT_SETTING:
        return put_setting(application, object, number_of(object, value));
    case OBJECT_COMMAND:
        return put_command(application, value[0]);
    case OBJECT_PARAMETER:
        memcpy((uint8_t *)&link->command + object->at, value, sizeof(double));
        return OBJECT_DONE;
    default:
        return link_obey(application, object, value);
    }
}
