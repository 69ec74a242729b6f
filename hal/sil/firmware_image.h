/*
 * A firmware image as the simulated board holds it: the entry points of one application with its
 * drive, built for one number format. The image is the only part of the simulator that is compiled
 * with the firmware; it carries no behaviour of its own.
 */
#ifndef STEADYSTEP_FIRMWARE_IMAGE_H
#define STEADYSTEP_FIRMWARE_IMAGE_H

#include "firmware/interface/drive_interface.h"
#include "hal/hal.h"

#ifdef __cplusplus
extern "C" {
#endif

struct firmware_image {
    const char *numeric; /* "float", "fixed", "double" or "one_motor" */
    size_t drive_bytes;  /* size of one application; allocate with alignment of max_align_t */

    /* Start-up: designs all gains. false: settings refused, reason in error. */
    bool (*init)(void *drive, const struct hal *board, const struct drive_settings *settings,
                 char error[DRIVE_ERROR_TEXT]);
    /* Start-up with the newest settings of the board's parameter store, or, without any, with the
       defaults for this motor. */
    bool (*init_stored)(void *drive, const struct hal *board,
                        const struct motor_params *motor_default, char error[DRIVE_ERROR_TEXT]);
    /* The control interrupt. */
    struct hal_outputs (*control_cycle)(void *drive, const struct hal_samples *samples);
    /* Behind it: whether the brake resistor is to be on until the next S(k). */
    bool (*brake)(void *drive, const struct hal_samples *samples);
    /* The gains that a law can be given by name, in the order of drive_settings.law_gains: the name
       of number `gain`, or NULL behind the last. */
    const char *(*law_gain)(enum position_law law, size_t gain);
    /* Posts a command (background), past the typed lines. false: refused, reason in error. */
    bool (*command)(void *drive, const struct drive_command *command, char error[DRIVE_ERROR_TEXT]);
    /* The application's background; once after each control interrupt. */
    void (*background)(void *drive);
    void (*signals)(const void *drive, struct drive_signals *signals);
    /* drive_hash so far: gains once, then duties and signals of every period (FNV-1a, 64 bit). */
    uint64_t (*hash)(const void *drive);
    /* So many words for captures, behind either init. */
    void (*put_memory)(void *drive, uint32_t *words, size_t count);
    /* Behind the control interrupt, while the board is asked to: application_follow_control. */
    void (*follow_control)(void *drive);
    /* The coefficients of firmware/drive/coefficients.h of a drive that is designed. */
    void (*coefficients)(const void *drive,
                         void (*view)(void *context, const char *name, double value),
                         void *context);
};

extern const struct firmware_image firmware_image_float;
extern const struct firmware_image firmware_image_fixed;
extern const struct firmware_image firmware_image_double;
extern const struct firmware_image firmware_image_one_motor; /* numeric/coefficients.h */

#ifdef __cplusplus
}
#endif

#endif
