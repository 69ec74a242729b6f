#include "firmware/design/text.h"

#include "firmware/design/elementary.h"
#include "firmware/linkage.h"

enum { EXPONENT_MIN = -4, EXPONENT_MAX = 5 };

/* value = d0.d1d2... x 10^exponent. */
struct decimal {
    uint32_t digit[TEXT_DIGITS_MAX];
    int count;
    int exponent;
};

CALLED_FROM_OUTSIDE struct text text_in(char *buffer, size_t room)
{
    buffer[0] = '\0';
    return (struct text){buffer, room, 0};
}

static void put_character(struct text *text, char character)
{
    if (text->length + 1u < text->room) {
        text->at[text->length++] = character;
        text->at[text->length] = '\0';
    }
}

CALLED_FROM_OUTSIDE void text_put(struct text *text, const char *words)
{
    for (; *words != '\0'; words++) {
        put_character(text, *words);
    }
}

/* Without a table: a board puts a crash into words before constants are in its memory. */
static void put_digit(struct text *text, uint32_t digit)
{
    put_character(text, (char)(digit < 10u ? '0' + digit : 'a' + (digit - 10u)));
}

CALLED_FROM_OUTSIDE void text_unsigned(struct text *text, uint32_t value)
{
    uint32_t unit = 1;

    while (value / unit >= 10u) {
        unit *= 10u;
    }
    for (; unit > 0u; unit /= 10u) {
        put_digit(text, value / unit % 10u);
    }
}

CALLED_FROM_OUTSIDE void text_hexadecimal(struct text *text, uint32_t value, int digits)
{
    for (int digit = digits - 1; digit >= 0; digit--) {
        put_digit(text, (value >> (4 * digit)) & 15u);
    }
}

/* value > 0 */
static struct decimal decimal_of(double value, int digits)
{
    struct decimal decimal = {.count = digits, .exponent = digits - 1};
    double top = 1.0; /* 10^digits */

    for (int i = 0; i < digits; i++) {
        top *= 10.0;
    }
    for (; value >= top - 0.5; decimal.exponent++) {
        value /= 10.0;
    }
    for (; value < top / 10.0 - 0.05; decimal.exponent--) {
        value *= 10.0;
    }
    uint32_t mantissa = (uint32_t)(value + 0.5);
    for (int i = digits - 1; i >= 0; i--) {
        decimal.digit[i] = mantissa % 10u;
        mantissa /= 10u;
    }
    while (decimal.count > 1 && decimal.digit[decimal.count - 1] == 0u) {
        decimal.count--;
    }
    return decimal;
}

/* From the weight 10^first_weight, or the units if that is less, down to the last digit. */
static void put_plain(struct text *text, const struct decimal *decimal, int first_weight)
{
    int weight = first_weight > 0 ? first_weight : 0;

    for (; weight >= 0 || first_weight - weight < decimal->count; weight--) {
        const int at = first_weight - weight;

        if (weight == -1) {
            text_put(text, ".");
        }
        put_digit(text, at >= 0 && at < decimal->count ? decimal->digit[at] : 0u);
    }
}

void text_number(struct text *text, double value, int digits)
{
    if (!is_finite(value)) {
        text_put(text, "(not finite)");
        return;
    }
    if (value == 0.0) {
        text_put(text, "0");
        return;
    }
    if (value < 0.0) {
        text_put(text, "-");
        value = -value;
    }
    const struct decimal decimal = decimal_of(value, digits);

    if (decimal.exponent >= EXPONENT_MIN &&
        decimal.exponent <= (digits > EXPONENT_MAX ? digits : EXPONENT_MAX)) {
        put_plain(text, &decimal, decimal.exponent);
        return;
    }
    put_plain(text, &decimal, 0);
    text_put(text, decimal.exponent < 0 ? "e-" : "e+");
    const int magnitude = decimal.exponent < 0 ? -decimal.exponent : decimal.exponent;

    for (int unit = magnitude >= 100 ? 100 : 10; unit > 0; unit /= 10) {
        put_digit(text, (uint32_t)(magnitude / unit % 10));
    }
}
