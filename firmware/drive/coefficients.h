/*
 * The coefficients of a drive that an image for one motor has the shifts of
 * (numeric/coefficients.h): those of the default law and of what it goes through in every period.
 * All others, of researchers' laws and of what is rare, have the shifts of their values in every
 * image.
 */
#ifndef STEADYSTEP_DRIVE_COEFFICIENTS_H
#define STEADYSTEP_DRIVE_COEFFICIENTS_H

#include "firmware/drive/drive.h"

/* Background: each of a drive that is designed, by its name; one name may come several times. */
void coefficients_show(const struct drive *drive, coefficient_viewer *view, void *context);

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS

/* Start-up: whether all but the law's are within their shifts, with room for what is learned in
   operation; false: refused, the first that is not in error. */
bool coefficients_fit(const struct drive *drive, char error[DRIVE_ERROR_TEXT]);

/* The same of a law's constants. */
bool coefficients_of_law_fit(enum position_law law, const union position_law_params *params,
                             char error[DRIVE_ERROR_TEXT]);

#else

static inline bool coefficients_fit(const struct drive *drive, char error[DRIVE_ERROR_TEXT])
{
    (void)drive;
    (void)error;
    return true;
}

static inline bool coefficients_of_law_fit(enum position_law law,
                                           const union position_law_params *params,
                                           char error[DRIVE_ERROR_TEXT])
{
    (void)law;
    (void)params;
    (void)error;
    return true;
}

#endif

#endif
