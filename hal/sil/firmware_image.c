#include "hal/sil/firmware_image.h"

#include "firmware/application/application.h"
#include "firmware/drive/coefficients.h"
#include "firmware/drive/drive_hash.h"
#include "firmware/linkage.h"

/* An application and the hash over what its drive has shown so far. */
struct instance {
    struct application application;
    uint64_t hash;
#ifndef STEADYSTEP_WITHOUT_LINK
    struct link link;
#endif
};

static void put_link(struct instance *self)
{
#ifndef STEADYSTEP_WITHOUT_LINK
    application_put_link(&self->application, &self->link);
#else
    (void)self;
#endif
}

static bool image_init(void *drive, const struct hal *board, const struct drive_settings *settings,
                       char error[DRIVE_ERROR_TEXT])
{
    struct instance *self = drive;

    if (!application_init_with(&self->application, board, settings, error)) {
        return false;
    }
    put_link(self);
    self->hash = self->application.gains_hash;
    return true;
}

static bool image_init_stored(void *drive, const struct hal *board,
                              const struct motor_params *motor_default,
                              char error[DRIVE_ERROR_TEXT])
{
    struct instance *self = drive;

    if (!application_init(&self->application, board, motor_default, error)) {
        return false;
    }
    put_link(self);
    self->hash = self->application.gains_hash;
    return true;
}

static struct hal_outputs image_control_cycle(void *drive, const struct hal_samples *samples)
{
    struct instance *self = drive;
    const struct hal_outputs *outputs = application_control_interrupt(&self->application, samples);

    self->hash = drive_hash_add(self->hash, drive_hash_row(&self->application.drive, outputs));
    return *outputs;
}

static bool image_brake(void *drive, const struct hal_samples *samples)
{
    struct instance *self = drive;

    return !application_brake_idles(&self->application, samples) &&
           application_brake(&self->application, samples);
}

static const char *image_law_gain(enum position_law law, size_t gain)
{
    const struct law_gain_list list = position_law_gains(law);

    return gain < list.count ? list.gain[gain].name : NULL;
}

static bool image_command(void *drive, const struct drive_command *command,
                          char error[DRIVE_ERROR_TEXT])
{
    struct instance *self = drive;
    struct drive_command asked = *command;

    return application_command(&self->application, &asked,
                               self->application.drive.supervision.period, error);
}

static void image_background(void *drive)
{
    struct instance *self = drive;

    application_background(&self->application);
}

static void image_signals(const void *drive, struct drive_signals *signals)
{
    const struct instance *self = drive;

    drive_signals_read(&self->application.drive, signals);
}

static void image_put_memory(void *drive, uint32_t *words, size_t count)
{
#ifndef STEADYSTEP_WITHOUT_LINK
    struct instance *self = drive;

    link_put_memory(&self->link, words, count);
#else
    (void)drive;
    (void)words;
    (void)count;
#endif
}

static void image_follow_control(void *drive)
{
    struct instance *self = drive;

    application_follow_control(&self->application);
}

static uint64_t image_hash(const void *drive)
{
    const struct instance *self = drive;

    return self->hash;
}

/* Who asked, of a coefficient in doubles. */
struct viewer {
    void (*view)(void *context, const char *name, double value);
    void *context;
};

static void view_double(void *context, const char *name, coef_t coefficient)
{
    const struct viewer *viewer = context;

    viewer->view(viewer->context, name, coef_to_double(coefficient));
}

static void image_coefficients(const void *drive,
                               void (*view)(void *context, const char *name, double value),
                               void *context)
{
    const struct instance *self = drive;
    struct viewer viewer = {view, context};

    coefficients_show(&self->application.drive, view_double, &viewer);
}

/* firmware_image_<format>, visible outside the linked image. */
#define EXPORTED            CALLED_FROM_OUTSIDE __attribute__((visibility("default")))
#define PASTE(a, b)         a##b
#define IMAGE_OF(format)    PASTE(firmware_image_, format)
#define STRING(token)       #token
#define STRING_OF(expanded) STRING(expanded)

EXPORTED const struct firmware_image IMAGE_OF(NUM_FORMAT) = {
    .numeric = STRING_OF(NUM_FORMAT),
    .drive_bytes = sizeof(struct instance),
    .init = image_init,
    .init_stored = image_init_stored,
    .control_cycle = image_control_cycle,
    .brake = image_brake,
    .law_gain = image_law_gain,
    .command = image_command,
    .background = image_background,
    .signals = image_signals,
    .hash = image_hash,
    .put_memory = image_put_memory,
    .follow_control = image_follow_control,
    .coefficients = image_coefficients,
};
