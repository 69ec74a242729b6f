/*
 * Coefficients by name, and the image for one motor.
 *
 * In fixed point a coefficient is a mantissa and a shift. The image for one motor has the shifts of
 * its coefficients from a header, STEADYSTEP_COEFFICIENT_SHIFTS, which `steadystep-sil shifts`
 * writes: for each NAME a line `#define COEF_SHIFT_NAME left - right`. A product is then two
 * multiplications and one shift that the compiler knows. Any other image takes the shifts as they
 * come.
 *
 * A struct of coefficients lists them behind its definition:
 *
 *   #define PLANT_COEFFICIENTS(X) X(gain, plant_gain) X(droop, plant_droop)    member, NAME
 *   COEFFICIENTS(plant, PLANT_COEFFICIENTS)
 *
 *   plant_fit_coefficients(k)        behind its design: to the nearest with the shifts of the image
 *   KNOWN(plant, k)                  in the interrupt: the coefficients of k, and nothing else of
 *                                    it, of which the compiler knows the shifts
 *   plant_show_coefficients(k, ...)  background: each by its name
 *
 * What does not fit is the largest number that does; drive/coefficients.h refuses it.
 */
#ifndef STEADYSTEP_COEFFICIENTS_H
#define STEADYSTEP_COEFFICIENTS_H

#include <stddef.h>

#include "firmware/numeric/num.h"

/* Sees a coefficient of that name; where sentences are left out, so are names: "". */
typedef void coefficient_viewer(void *context, const char *name, coef_t coefficient);

struct coefficient_row {
    uint8_t offset; /* in its struct */
#ifdef STEADYSTEP_COEFFICIENT_SHIFTS
    int8_t shift; /* left minus right */
#endif
#ifndef STEADYSTEP_WITHOUT_SENTENCES
    const char *name;
#endif
};

void coefficients_view(const void *owner, const struct coefficient_row *rows, size_t count,
                       coefficient_viewer *view, void *context);

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS
#define COEFFICIENT_SHIFT(name) , COEF_SHIFT_##name
#else
#define COEFFICIENT_SHIFT(name)
#endif
#ifdef STEADYSTEP_WITHOUT_SENTENCES
#define COEFFICIENT_NAME(name)
#else
#define COEFFICIENT_NAME(name) , #name
#endif
#define COEFFICIENT_ROW(member, name)                                                              \
    {offsetof(owner, member) COEFFICIENT_SHIFT(name) COEFFICIENT_NAME(name)},
#define COEFFICIENT_ROWS(tag, list)                                                                \
    typedef struct tag owner;                                                                      \
    static const struct coefficient_row rows[] = {list(COEFFICIENT_ROW)}

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS

void coefficients_fit_rows(void *owner, const struct coefficient_row *rows, size_t count);

#define COEFFICIENT_KNOW(member, name)                                                             \
    known.member = coef_with_shift(k->member.mantissa, COEF_SHIFT_##name);

#define COEFFICIENTS_FIT_AND_KNOW(tag, list)                                                       \
    static inline void tag##_fit_coefficients(struct tag *k)                                       \
    {                                                                                              \
        COEFFICIENT_ROWS(tag, list);                                                               \
        coefficients_fit_rows(k, rows, sizeof rows / sizeof rows[0]);                              \
    }                                                                                              \
    __attribute__((always_inline)) static inline struct tag tag##_known(const struct tag *k)       \
    {                                                                                              \
        struct tag known;                                                                          \
                                                                                                   \
        list(COEFFICIENT_KNOW) return known;                                                       \
    }
#define KNOWN(tag, pointer) ((const struct tag[]){tag##_known(pointer)})

#else

#define COEFFICIENTS_FIT_AND_KNOW(tag, list)                                                       \
    static inline void tag##_fit_coefficients(struct tag *k)                                       \
    {                                                                                              \
        (void)k;                                                                                   \
    }
#define KNOWN(tag, pointer) (pointer)

#endif

#define COEFFICIENTS(tag, list)                                                                    \
    COEFFICIENTS_FIT_AND_KNOW(tag, list)                                                           \
    static inline void tag##_show_coefficients(const struct tag *k, coefficient_viewer *view,      \
                                               void *context)                                      \
    {                                                                                              \
        COEFFICIENT_ROWS(tag, list);                                                               \
        coefficients_view(k, rows, sizeof rows / sizeof rows[0], view, context);                   \
    }

#endif
