#include "firmware/numeric/coefficients.h"

void coefficients_view(const void *owner, const struct coefficient_row *rows, size_t count,
                       coefficient_viewer *view, void *context)
{
    for (size_t i = 0; i < count; i++) {
        const coef_t *coefficient = (const void *)((const char *)owner + rows[i].offset);

#ifdef STEADYSTEP_WITHOUT_SENTENCES
        view(context, "", *coefficient);
#else
        view(context, rows[i].name, *coefficient);
#endif
    }
}

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS

void coefficients_fit_rows(void *owner, const struct coefficient_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        coef_t *coefficient = (void *)((char *)owner + rows[i].offset);

        *coefficient = coef_of_shift(coef_to_double(*coefficient), rows[i].shift);
    }
}

#endif
