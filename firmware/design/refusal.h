/* The one form in which a design says no: what was asked, the limit, and the reason for it. */
#ifndef STEADYSTEP_REFUSAL_H
#define STEADYSTEP_REFUSAL_H

#include <stdbool.h>

enum { DESIGN_ERROR_TEXT = 160 }; /* bytes of every `error` argument, terminator included */

/* Copies `text` to `error`. Returns false, so that a design ends with `return design_refuse(...)`.
 */
bool design_refuse(char error[DESIGN_ERROR_TEXT], const char *text);

/* A quantity a design was asked for and the bound it breaks. */
struct refusal {
    const char *quantity; /* "law bandwidth" */
    double value;
    const char *relation; /* "at most", "above", ... */
    double limit;
    const char *unit;   /* of value and limit */
    const char *reason; /* where the limit comes from */
};

/*
 * Writes "<quantity> <value> <unit>: must be <relation> <limit> <unit>, <reason>", numbers with
 * four significant digits, seven where four do not distinguish them, cut to fit. Returns false.
 */
bool design_refuse_limit(char error[DESIGN_ERROR_TEXT], struct refusal refusal);

/* value > 0 and finite, or a refusal naming `quantity`. */
bool design_require_positive(char error[DESIGN_ERROR_TEXT], const char *quantity, double value,
                             const char *unit);

/* low <= value <= high, which a NaN is not; or a refusal naming the bound that is broken. */
bool design_require_within(char error[DESIGN_ERROR_TEXT], const char *quantity, double value,
                           double low, double high, const char *unit, const char *reason);

#endif
