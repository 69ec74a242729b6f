#include "firmware/link/slcan.h"

/* -1: no hexadecimal digit. */
static int digit_of(char character)
{
    if (character >= '0' && character <= '9') {
        return character - '0';
    }
    if (character >= 'A' && character <= 'F') {
        return character - 'A' + 10;
    }
    return character >= 'a' && character <= 'f' ? character - 'a' + 10 : -1;
}

/* false: some are no hexadecimal digits. */
static bool read_number(const char *text, size_t digits, uint32_t *number)
{
    *number = 0;
    for (size_t i = 0; i < digits; i++) {
        const int digit = digit_of(text[i]);

        if (digit < 0) {
            return false;
        }
        *number = *number << 4 | (uint32_t)digit;
    }
    return true;
}

/* Behind the letter: identifier, count of bytes, bytes. */
static enum slcan_meaning read_frame(const char *text, size_t length, struct can_frame *frame)
{
    uint32_t id;
    uint32_t bytes;

    if (length < 4u || !read_number(text, 3, &id) || !read_number(&text[3], 1, &bytes) ||
        bytes > 8u || length != 4u + 2u * bytes || id > 0x7ffu) {
        return SLCAN_REFUSED;
    }
    frame->id = (uint16_t)id;
    frame->length = (uint8_t)bytes;
    for (size_t i = 0; i < bytes; i++) {
        uint32_t byte;

        if (!read_number(&text[4u + 2u * i], 2, &byte)) {
            return SLCAN_REFUSED;
        }
        frame->data[i] = (uint8_t)byte;
    }
    return SLCAN_SENDS;
}

/* A rate, any, as there is no bus to be out of step with; a filter, time stamps. */
static bool is_setting(char letter, const char *text, size_t length)
{
    uint32_t number;

    for (const char *known = "SsUXYZMm"; *known != '\0'; known++) {
        if (*known == letter) {
            return read_number(text, length, &number);
        }
    }
    return false;
}

static enum slcan_meaning read_letter(char letter)
{
    switch (letter) {
    case 'O':
        return SLCAN_OPENS;
    case 'L':
        return SLCAN_LISTENS;
    case 'C':
        return SLCAN_CLOSES;
    case 'V':
    case 'v':
        return SLCAN_ASKS_VERSION;
    case 'N':
        return SLCAN_ASKS_SERIAL;
    case 'F':
        return SLCAN_ASKS_FLAGS;
    default:
        return SLCAN_UNKNOWN;
    }
}

enum slcan_meaning slcan_read(const char *line, size_t length, struct can_frame *frame)
{
    if (length == 0u || length > SLCAN_LINE_BYTES) {
        return SLCAN_UNKNOWN;
    }
    if (line[0] == 't' && (length == 1u || line[1] != 'o')) { /* else it is `torque` */
        return read_frame(&line[1], length - 1u, frame);
    }
    if (length == 1u) {
        return read_letter(line[0]);
    }
    return is_setting(line[0], &line[1], length - 1u) ? SLCAN_SETS : SLCAN_UNKNOWN;
}

const char *slcan_answer(enum slcan_meaning meaning, bool open)
{
    switch (meaning) {
    case SLCAN_SETS:
    case SLCAN_OPENS:
    case SLCAN_LISTENS:
    case SLCAN_CLOSES:
        return "\r";
    case SLCAN_SENDS:
        return open ? "z\r" : "\a";
    case SLCAN_ASKS_VERSION:
        return "V1010\r";
    case SLCAN_ASKS_SERIAL:
        return "N0001\r";
    case SLCAN_ASKS_FLAGS:
        return "F00\r";
    default:
        return "\a";
    }
}

static char *put_digits(char *text, uint32_t number, unsigned digits)
{
    while (digits-- > 0u) {
        *text++ = "0123456789ABCDEF"[number >> 4u * digits & 15u];
    }
    return text;
}

size_t slcan_write(const struct can_frame *frame, char *text)
{
    char *end = text;

    *end++ = 't';
    end = put_digits(end, frame->id, 3);
    end = put_digits(end, frame->length, 1);
    for (size_t i = 0; i < frame->length; i++) {
        end = put_digits(end, frame->data[i], 2);
    }
    *end++ = '\r';
    return (size_t)(end - text);
}
