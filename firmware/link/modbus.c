#include "firmware/link/modbus.h"

#include "firmware/application/application.h"
#include "firmware/drive/interrupt_view.h"
#include "firmware/link/can_frame.h"
#include "firmware/link/objects.h"

enum modbus_function {
    READ_HOLDING_REGISTERS = 3,
    READ_INPUT_REGISTERS = 4,
    WRITE_REGISTER = 6,
    DIAGNOSTICS = 8,
    WRITE_REGISTERS = 16
};

/* node, function, address (2), count or value (2), CRC (2); WRITE_REGISTERS has bytes behind them
 */
enum {
    HEAD_BYTES = 6,
    CRC_BYTES = 2,
    SHORT_BYTES = HEAD_BYTES + CRC_BYTES,
    LEAST_BYTES = 4,
    ALL_NODES = 0,
    READ_MOST = 125,
    FAILED = 0x80
};

static uint16_t word_at(const uint8_t *bytes)
{
    return (uint16_t)(bytes[0] << 8 | bytes[1]);
}

static uint8_t *put_word(uint8_t *bytes, uint16_t word)
{
    *bytes++ = (uint8_t)(word >> 8);
    *bytes++ = (uint8_t)word;
    return bytes;
}

uint16_t modbus_crc(const uint8_t *frame, size_t length)
{
    uint32_t crc = 0xffff;

    for (size_t i = 0; i < length; i++) {
        crc ^= frame[i];
        for (int bit = 0; bit < 8; bit++) {
            crc = (crc & 1u) != 0u ? crc >> 1 ^ 0xa001u : crc >> 1;
        }
    }
    return (uint16_t)crc;
}

/* Bytes of a request; 0: its beginning does not say. */
static size_t request_bytes(const uint8_t *frame, size_t length)
{
    switch (frame[1]) {
    case READ_HOLDING_REGISTERS:
    case READ_INPUT_REGISTERS:
    case WRITE_REGISTER:
    case DIAGNOSTICS:
        return SHORT_BYTES;
    case WRITE_REGISTERS:
        return length > HEAD_BYTES ? SHORT_BYTES + 1u + frame[HEAD_BYTES] : SHORT_BYTES + 1u;
    default:
        return 0;
    }
}

bool modbus_is_whole(const uint8_t *frame, size_t length)
{
    return length >= LEAST_BYTES && request_bytes(frame, length) == length &&
           modbus_crc(frame, length) == 0u;
}

/* Of a function that is not served the length is the one that came. */
static bool is_request(const uint8_t *frame, size_t length)
{
    return modbus_is_whole(frame, length) ||
           (length >= LEAST_BYTES && request_bytes(frame, length) == 0u &&
            modbus_crc(frame, length) == 0u);
}

/* ---- registers of objects ---- */

/* An object's values, one behind another. */
struct cursor {
    struct object object;
    uint16_t index;
    uint8_t sub;
};

static struct cursor values_from(uint16_t index)
{
    struct cursor values = {.index = index};

    if (objects_find(index, 1, &values.object) == OBJECT_DONE) {
        values.sub = 1;
    }
    return values;
}

static enum object_abort next_value(struct cursor *values)
{
    const enum object_abort abort = objects_find(values->index, values->sub, &values->object);

    values->sub++;
    return abort;
}

static size_t registers_of(const struct object *object)
{
    return (object_bytes(object) + 1u) / 2u;
}

static bool is_negative(const struct object *object, uint8_t value)
{
    return object->type == OBJECT_I8 && value > INT8_MAX;
}

/* `value`: lowest byte first. */
static void put_registers(const struct object *object, const uint8_t *value, uint8_t *registers)
{
    const size_t bytes = 2u * registers_of(object);

    if (object_bytes(object) == 1u) {
        registers[0] = is_negative(object, value[0]) ? 0xff : 0;
        registers[1] = value[0];
        return;
    }
    for (size_t i = 0; i < bytes; i++) {
        registers[i] = value[bytes - 1u - i];
    }
}

/* false: more than the object's one byte can have. */
static bool get_registers(const struct object *object, const uint8_t *registers, uint8_t *value)
{
    const size_t bytes = 2u * registers_of(object);

    if (object_bytes(object) == 1u) {
        value[0] = registers[1];
        return registers[0] == (is_negative(object, value[0]) ? 0xff : 0);
    }
    for (size_t i = 0; i < bytes; i++) {
        value[i] = registers[bytes - 1u - i];
    }
    return true;
}

static enum modbus_exception exception_of(enum object_abort abort)
{
    switch (abort) {
    case OBJECT_DONE:
        return MODBUS_NONE;
    case OBJECT_MISSING:
    case OBJECT_SUB_MISSING:
    case OBJECT_READ_ONLY:
    case OBJECT_WRITE_ONLY:
        return MODBUS_ADDRESS;
    case OBJECT_WRONG_LENGTH:
    case OBJECT_OUT_OF_RANGE:
    case OBJECT_NOT_TRANSFERRED:
    case OBJECT_NOT_MAPPABLE:
    case OBJECT_PDO_TOO_LONG:
        return MODBUS_VALUE;
    default:
        return MODBUS_FAILURE;
    }
}

static void put_text(const char *text, uint8_t *registers, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++) {
        registers[i] = (uint8_t)*text;
        text += *text != '\0' ? 1 : 0;
    }
}

static enum modbus_exception read(struct application *application, uint16_t index, size_t count,
                                  uint8_t *registers)
{
    struct cursor values = values_from(index);

    for (size_t done = 0; done < count; done += registers_of(&values.object)) {
        uint8_t value[OBJECT_BYTES_MAX];
        const char *text = NULL;
        enum object_abort abort = next_value(&values);

        if (abort == OBJECT_DONE) {
            abort = object_get(application, &values.object, value, &text);
        }
        if (abort != OBJECT_DONE) {
            return exception_of(abort);
        }
        if (values.object.type == OBJECT_TEXT) {
            put_text(text, registers, 2u * count);
            return MODBUS_NONE;
        }
        if (object_bytes(&values.object) == 0u) {
            return MODBUS_ADDRESS;
        }
        if (done + registers_of(&values.object) > count) {
            return MODBUS_VALUE;
        }
        put_registers(&values.object, value, &registers[2u * done]);
    }
    return MODBUS_NONE;
}

static enum modbus_exception write(struct application *application, uint16_t index, size_t count,
                                   const uint8_t *registers)
{
    struct cursor values = values_from(index);

    for (size_t done = 0; done < count; done += registers_of(&values.object)) {
        uint8_t value[OBJECT_BYTES_MAX];
        enum object_abort abort = next_value(&values);

        if (abort == OBJECT_DONE && object_bytes(&values.object) == 0u) {
            abort = OBJECT_READ_ONLY;
        }
        if (abort == OBJECT_DONE &&
            (done + registers_of(&values.object) > count ||
             !get_registers(&values.object, &registers[2u * done], value))) {
            abort = OBJECT_WRONG_LENGTH;
        }
        if (abort == OBJECT_DONE) {
            abort = object_put(application, &values.object, value);
        }
        if (abort != OBJECT_DONE) {
            return exception_of(abort);
        }
    }
    return MODBUS_NONE;
}

/* ---- requests ---- */

/* The response behind node and function; moves its end. */
static enum modbus_exception obey(struct application *application, const uint8_t *request,
                                  uint8_t **end)
{
    const uint16_t address = word_at(&request[2]);
    const uint16_t count = word_at(&request[4]);
    const size_t bytes = (size_t)2 * count;
    enum modbus_exception exception = MODBUS_NONE;

    switch (request[1]) {
    case READ_HOLDING_REGISTERS:
    case READ_INPUT_REGISTERS:
        if (count == 0u || count > READ_MOST) {
            return MODBUS_VALUE;
        }
        *(*end)++ = (uint8_t)bytes;
        exception = read(application, address, count, *end);
        *end += bytes;
        return exception;
    case WRITE_REGISTER:
        exception = write(application, address, 1, &request[4]);
        break;
    case WRITE_REGISTERS:
        if (count == 0u || request[HEAD_BYTES] != bytes) {
            return MODBUS_VALUE;
        }
        exception = write(application, address, count, &request[HEAD_BYTES + 1]);
        break;
    case DIAGNOSTICS:
        if (address != 0u) {
            return MODBUS_FUNCTION;
        }
        break;
    default:
        return MODBUS_FUNCTION;
    }
    *end = put_word(put_word(*end, address), count); /* as they came */
    return exception;
}

size_t modbus_serve(struct application *application, uint8_t node, const uint8_t *request,
                    size_t length, uint8_t response[MODBUS_RESPONSE_BYTES])
{
    uint8_t *end = &response[2];

    if (!is_request(request, length) || (request[0] != node && request[0] != ALL_NODES)) {
        return 0;
    }
    application_hear(application, interrupt_view_period(&application->drive));
    response[0] = request[0];
    response[1] = request[1];

    const enum modbus_exception exception =
        length < SHORT_BYTES ? MODBUS_FUNCTION : obey(application, request, &end);

    if (exception != MODBUS_NONE) {
        response[1] |= FAILED;
        response[2] = (uint8_t)exception;
        end = &response[3];
    }

    const size_t bytes = (size_t)(end - response);

    can_put(end, modbus_crc(response, bytes), CRC_BYTES); /* lowest first */
    return request[0] == ALL_NODES ? 0 : bytes + CRC_BYTES;
}
