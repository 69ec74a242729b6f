#include "firmware/design/refusal.h"

#include "firmware/design/elementary.h"
#include "firmware/design/text.h"

enum { DIGITS = 4, MORE_DIGITS = 7 };

/* As many as distinguish a value from its limit. */
static int digits_of(double value, double limit)
{
    return magnitude(value - limit) < 1e-4 * magnitude(limit) ? MORE_DIGITS : DIGITS;
}

bool design_refuse(char error[DESIGN_ERROR_TEXT], const char *text)
{
    struct text refusal = text_in(error, DESIGN_ERROR_TEXT);

    text_put(&refusal, text);
    return false;
}

bool design_refuse_limit(char error[DESIGN_ERROR_TEXT], struct refusal refusal)
{
    struct text text = text_in(error, DESIGN_ERROR_TEXT);
    const int digits = digits_of(refusal.value, refusal.limit);
    const char *space = refusal.unit[0] != '\0' ? " " : "";

    text_put(&text, refusal.quantity);
    text_put(&text, " ");
    text_number(&text, refusal.value, digits);
    text_put(&text, space);
    text_put(&text, refusal.unit);
    text_put(&text, ": must be ");
    text_put(&text, refusal.relation);
    text_put(&text, " ");
    text_number(&text, refusal.limit, digits);
    text_put(&text, space);
    text_put(&text, refusal.unit);
    text_put(&text, ", ");
    text_put(&text, refusal.reason);
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
