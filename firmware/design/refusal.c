#include "firmware/design/refusal.h"

#include <stdint.h>

#include "firmware/design/elementary.h"

struct writer {
    char *text;
    int length;
};

static void write_text(struct writer *writer, const char *text)
{
    for (; *text != '\0' && writer->length < DESIGN_ERROR_TEXT - 1; text++) {
        writer->text[writer->length++] = *text;
    }
    writer->text[writer->length] = '\0';
}

enum { DIGITS = 4, EXPONENT_MIN = -4, EXPONENT_MAX = 5 };

/* value = d0.d1d2d3 x 10^exponent; value > 0. */
struct decimal {
    int32_t digits[DIGITS];
    int exponent;
};

static struct decimal decimal_of(double value)
{
    struct decimal decimal = {.exponent = DIGITS - 1};

    for (; value >= 9999.5; decimal.exponent++) {
        value /= 10.0;
    }
    for (; value < 999.95; decimal.exponent--) {
        value *= 10.0;
    }
    int32_t mantissa = (int32_t)(value + 0.5);
    for (int i = DIGITS - 1; i >= 0; i--) {
        decimal.digits[i] = mantissa % 10;
        mantissa /= 10;
    }
    return decimal;
}

static void write_digit(struct writer *writer, int32_t digit)
{
    const char text[2] = {(char)('0' + digit), '\0'};

    write_text(writer, text);
}

/* Digits with weights 10^first_weight down to the units, then the decimals that are not zero. */
static void write_plain(struct writer *writer, const int32_t digits[DIGITS], int first_weight)
{
    int last = DIGITS - 1; /* last digit worth writing */

    while (last > 0 && digits[last] == 0) {
        last--;
    }
    int weight = first_weight > 0 ? first_weight : 0;
    for (; weight >= 0 || first_weight - weight <= last; weight--) {
        int at = first_weight - weight;
        if (weight == -1) {
            write_text(writer, ".");
        }
        write_digit(writer, at >= 0 && at < DIGITS ? digits[at] : 0);
    }
}

/* Four significant digits: 0.0312, 1500, 2.5e-07. */
static void write_number(struct writer *writer, double value)
{
    if (!is_finite(value)) {
        write_text(writer, "(not finite)");
        return;
    }
    if (value == 0.0) {
        write_text(writer, "0");
        return;
    }
    if (value < 0.0) {
        write_text(writer, "-");
        value = -value;
    }
    struct decimal decimal = decimal_of(value);
    if (decimal.exponent >= EXPONENT_MIN && decimal.exponent <= EXPONENT_MAX) {
        write_plain(writer, decimal.digits, decimal.exponent);
        return;
    }
    write_plain(writer, decimal.digits, 0);
    write_text(writer, decimal.exponent < 0 ? "e-" : "e+");
    int magnitude = decimal.exponent < 0 ? -decimal.exponent : decimal.exponent;
    for (int unit = magnitude >= 100 ? 100 : 10; unit > 0; unit /= 10) {
        write_digit(writer, magnitude / unit % 10);
    }
}

bool design_refuse(char error[DESIGN_ERROR_TEXT], const char *text)
{
    struct writer writer = {error, 0};

    write_text(&writer, text);
    return false;
}

bool design_refuse_limit(char error[DESIGN_ERROR_TEXT], struct refusal refusal)
{
    struct writer writer = {error, 0};

    write_text(&writer, refusal.quantity);
    write_text(&writer, " ");
    write_number(&writer, refusal.value);
    write_text(&writer, " ");
    write_text(&writer, refusal.unit);
    write_text(&writer, ": must be ");
    write_text(&writer, refusal.relation);
    write_text(&writer, " ");
    write_number(&writer, refusal.limit);
    write_text(&writer, " ");
    write_text(&writer, refusal.unit);
    write_text(&writer, ", ");
    write_text(&writer, refusal.reason);
    return false;
}

bool design_require_positive(char error[DESIGN_ERROR_TEXT], const char *quantity, double value,
                             const char *unit)
{
    if (value > 0.0 && is_finite(value)) {
        return true;
    }
    return design_refuse_limit(error, (struct refusal){.quantity = quantity,
                                                       .value = value,
                                                       .relation = "above",
                                                       .limit = 0.0,
                                                       .unit = unit,
                                                       .reason = "and finite"});
}

bool design_require_within(char error[DESIGN_ERROR_TEXT], const char *quantity, double value,
                           double low, double high, const char *unit, const char *reason)
{
    if (value >= low && value <= high) {
        return true;
    }
    return design_refuse_limit(error,
                               (struct refusal){.quantity = quantity,
                                                .value = value,
                                                .relation = value > high ? "at most" : "at least",
                                                .limit = value > high ? high : low,
                                                .unit = unit,
                                                .reason = reason});
}
