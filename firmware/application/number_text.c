#include "firmware/application/number_text.h"

enum {
    EXPONENT_TEN_MAX = 22, /* 10^22 is the largest power of ten that is a double */
    EXPONENT_TYPED_MAX = 9999,
    EXPONENT_TWO_MIN = -1022, /* of a normal double */
    EXPONENT_TWO_MAX = 1023,
    FRACTION_BITS = 52
};

static const uint64_t mantissa_max = UINT64_C(1) << 53;

struct reader {
    const char *at;
    const char *end;
};

/* A typed number without its sign: mantissa x base^exponent, zeros at the end taken off. */
struct digits {
    uint64_t mantissa;
    int exponent;
    int count; /* of digits, zeros included */
    bool too_long;
};

static bool take(struct reader *reader, char lower, char upper)
{
    if (reader->at < reader->end && (*reader->at == lower || *reader->at == upper)) {
        reader->at++;
        return true;
    }
    return false;
}

/* The digit that follows; -1: none. */
static int take_digit(struct reader *reader, int base)
{
    if (reader->at == reader->end) {
        return -1;
    }
    const char c = *reader->at;
    const int digit = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                      : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                             : -1;

    if (digit < 0 || digit >= base) {
        return -1;
    }
    reader->at++;
    return digit;
}

static void push(struct digits *digits, int digit, int base)
{
    const uint64_t longer = digits->mantissa * (uint64_t)base + (uint64_t)digit;

    if (digits->too_long || longer > mantissa_max) {
        digits->too_long = true;
    } else {
        digits->mantissa = longer;
    }
}

/* "12.50" is 125 x 10^-1: zeros count once a digit follows them. */
static struct digits take_digits(struct reader *reader, int base)
{
    struct digits digits = {.mantissa = 0};
    int zeros = 0;
    bool fraction = false;

    for (;;) {
        if (!fraction && take(reader, '.', '.')) {
            fraction = true;
            continue;
        }
        const int digit = take_digit(reader, base);

        if (digit < 0) {
            break;
        }
        digits.count++;
        digits.exponent -= fraction ? 1 : 0;
        if (digit == 0) {
            zeros += digits.mantissa > 0u ? 1 : 0;
            continue;
        }
        for (; zeros > 0 && !digits.too_long; zeros--) {
            push(&digits, 0, base);
        }
        push(&digits, digit, base);
    }
    digits.exponent += zeros;
    return digits;
}

/* Sign and digits; false: there are none. */
static bool take_exponent(struct reader *reader, int *exponent)
{
    const bool negative = take(reader, '-', '-');
    int value = 0;
    int digit;

    if (!negative) {
        (void)take(reader, '+', '+');
    }
    const char *begin = reader->at;

    while ((digit = take_digit(reader, 10)) >= 0) {
        value = value < EXPONENT_TYPED_MAX ? 10 * value + digit : value;
    }
    *exponent = negative ? -value : value;
    return reader->at != begin;
}

/* A product or a quotient of two doubles that are exact: rounded once. */
static enum number_text decimal(const struct digits *digits, int exponent, double *value)
{
    uint64_t mantissa = digits->mantissa;
    double power = 1.0;

    for (; exponent > EXPONENT_TEN_MAX && mantissa <= mantissa_max / 10u; exponent--) {
        mantissa *= 10u;
    }
    if (exponent > EXPONENT_TEN_MAX || exponent < -EXPONENT_TEN_MAX) {
        return NUMBER_TEXT_OUT_OF_RANGE;
    }
    for (int i = exponent < 0 ? -exponent : exponent; i > 0; i--) {
        power *= 10.0;
    }
    *value = exponent < 0 ? (double)mantissa / power : (double)mantissa * power;
    return NUMBER_TEXT_READ;
}

/* Put together from its bits. */
static enum number_text hexadecimal(const struct digits *digits, int exponent, double *value)
{
    uint64_t mantissa = digits->mantissa;

    exponent += FRACTION_BITS;
    for (; mantissa >= mantissa_max; exponent++) { /* 2^53 itself */
        mantissa >>= 1;
    }
    for (; mantissa < mantissa_max / 2u; exponent--) {
        mantissa <<= 1;
    }
    if (exponent < EXPONENT_TWO_MIN || exponent > EXPONENT_TWO_MAX) {
        return NUMBER_TEXT_OUT_OF_RANGE;
    }
    const union {
        uint64_t bits;
        double value;
    } number = {.bits = ((uint64_t)(exponent - EXPONENT_TWO_MIN + 1) << FRACTION_BITS) |
                        (mantissa & (mantissa_max / 2u - 1u))};

    *value = number.value;
    return NUMBER_TEXT_READ;
}

enum number_text number_from_text(const char *text, size_t length, double *value)
{
    struct reader reader = {text, text + length};
    const bool negative = take(&reader, '-', '-');
    double magnitude = 0.0;
    int exponent = 0;

    if (!negative) {
        (void)take(&reader, '+', '+');
    }
    const bool hex = reader.end - reader.at > 2 && reader.at[0] == '0' &&
                     (reader.at[1] == 'x' || reader.at[1] == 'X');

    reader.at += hex ? 2 : 0;
    const struct digits digits = take_digits(&reader, hex ? 16 : 10);
    const bool has_exponent = hex ? take(&reader, 'p', 'P') : take(&reader, 'e', 'E');

    if (digits.count == 0 || (has_exponent && !take_exponent(&reader, &exponent)) ||
        reader.at != reader.end) {
        return NUMBER_TEXT_MALFORMED;
    }
    if (digits.too_long) {
        return NUMBER_TEXT_TOO_LONG;
    }
    if (digits.mantissa > 0u) {
        const enum number_text answer =
            hex ? hexadecimal(&digits, exponent + 4 * digits.exponent, &magnitude)
                : decimal(&digits, exponent + digits.exponent, &magnitude);

        if (answer != NUMBER_TEXT_READ) {
            return answer;
        }
    }
    *value = negative ? -magnitude : magnitude;
    return NUMBER_TEXT_READ;
}

bool unsigned_from_text(const char *text, size_t length, uint32_t *value)
{
    struct reader reader = {text, text + length};
    uint64_t number = 0;
    int digit;

    while (number <= UINT32_MAX && (digit = take_digit(&reader, 10)) >= 0) {
        number = 10u * number + (uint64_t)digit;
    }
    if (length == 0u || reader.at != reader.end || number > UINT32_MAX) {
        return false;
    }
    *value = (uint32_t)number;
    return true;
}
