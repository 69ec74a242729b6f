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

#include "firmware/numeric/num.h"

/* Sees a coefficient of that name; `shift` is left minus right. */
typedef void coefficient_viewer(void *context, const char *name, coef_t coefficient);

#define COEFFICIENT_SHOW(member, name) view(context, #name, k->member);

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS

#define COEFFICIENT_FIT(member, name)                                                              \
    k->member = coef_of_shift(coef_to_double(k->member), COEF_SHIFT_##name);
#define COEFFICIENT_KNOW(member, name)                                                             \
    known.member = coef_with_shift(k->member.mantissa, COEF_SHIFT_##name);

#define COEFFICIENTS_FIT_AND_KNOW(tag, list)                                                       \
    static inline void tag##_fit_coefficients(struct tag *k)                                       \
    {                                                                                              \
        list(COEFFICIENT_FIT)                                                                      \
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
        list(COEFFICIENT_SHOW)                                                                     \
    }

#endif
