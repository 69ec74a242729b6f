#include "hal/sil/firmware_image.h"

#include "firmware/drive/drive.h"

/* A drive and the hash over what it has shown so far. */
struct instance {
    struct drive drive;
    uint64_t hash;
};

static uint64_t fnv1a(uint64_t hash, uint32_t word)
{
    return (hash ^ word) * 0x100000001b3u;
}

static uint64_t hash_coefs(uint64_t hash, const coef_t *coefs, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof *coefs; i++) {
        hash = fnv1a(hash, coef_bits(coefs[i]));
    }
    return hash;
}

#define HASH_RANGE(hash, object, first, last)                                                      \
    hash_coefs(hash, &(object).first,                                                              \
               (size_t)((const char *)(&(object).last + 1) - (const char *)&(object).first))

/* A law's constants are coef_t and num_t, without a gap. */
static uint64_t hash_law(uint64_t hash, const struct drive_params *p)
{
    const uint8_t *byte = (const uint8_t *)&p->law;
    size_t bytes = 0;

#define LAW_BYTES(constant, function, text)                                                        \
    if (p->position_law == POSITION_LAW_##constant) {                                              \
        bytes = sizeof p->law.function;                                                            \
    }
    POSITION_LAWS(LAW_BYTES)
#undef LAW_BYTES
    for (size_t i = 0; i < bytes; i++) {
        hash = fnv1a(hash, byte[i]);
    }
    return hash;
}

static uint64_t hash_estimator(uint64_t hash, const struct estimator_params *p)
{
    switch (p->kind) {
    case ESTIMATOR_INVARIANT_EKF:
        hash = HASH_RANGE(hash, p->invariant.moving, current, resistance);
        hash = HASH_RANGE(hash, p->invariant.holding, current, resistance);
        return HASH_RANGE(hash, p->invariant.following, current, resistance);
    case ESTIMATOR_STEADY_STATE_EKF:
        return HASH_RANGE(hash, p->steady_state, rotation, gain_load);
    case ESTIMATOR_HIGH_GAIN_OBSERVER:
        hash = HASH_RANGE(hash, p->high_gain, transition[0][0], acceleration_per_turn);
        break;
    case ESTIMATOR_ENCODER_OBSERVER:
        break;
    }
    return HASH_RANGE(hash, p->encoder, gain_angle, gain_resistance);
}

/* Every gain of the design, once. */
static uint64_t hash_gains(uint64_t hash, const struct drive_params *p)
{
    hash = HASH_RANGE(hash, p->measurement, current, bus_voltage);
    hash = HASH_RANGE(hash, p->model, rate, admittance_per_resistance);
    hash = hash_estimator(hash, &p->estimator);
    hash = HASH_RANGE(hash, p->reference, speed, jerk);
    hash = hash_law(hash, p);
    hash = HASH_RANGE(hash, p->current_control, proportional, reactance);
    hash = fnv1a(hash, coef_bits(p->hold.damping));
    return fnv1a(hash, coef_bits(p->modulator.counts));
}

static uint64_t hash_signals(uint64_t hash, const struct drive *drive,
                             const struct hal_outputs *outputs)
{
    const struct rotor *rotor =
        &estimator_estimate(&drive->estimator, &drive->params.estimator)->rotor;

    for (int leg = 0; leg < HAL_LEGS; leg += 2) {
        hash = fnv1a(hash,
                     ((uint32_t)outputs->high_counts[leg] << 16) | outputs->high_counts[leg + 1]);
    }
    hash = fnv1a(hash, ((uint32_t)drive->state << 1) | (outputs->bridge_on ? 1u : 0u));
    hash = fnv1a(hash, (uint32_t)rotor->position.turns);
    hash = fnv1a(hash, rotor->position.fraction);
    hash = fnv1a(hash, num_bits(rotor->speed));
    hash = fnv1a(hash, num_bits(rotor->load_torque));
    hash = fnv1a(hash, num_bits(drive->current.d));
    return fnv1a(hash, num_bits(drive->current.q));
}

static bool image_init(void *drive, const struct hal *board, const struct drive_settings *settings,
                       char error[DRIVE_ERROR_TEXT])
{
    struct instance *self = drive;

    if (!drive_init(&self->drive, board, settings, error)) {
        return false;
    }
    self->hash = hash_gains(0xcbf29ce484222325u, &self->drive.params);
    return true;
}

static struct hal_outputs image_control_cycle(void *drive, const struct hal_samples *samples)
{
    struct instance *self = drive;
    const struct hal_outputs outputs = drive_control_cycle(&self->drive, samples);

    self->hash = hash_signals(self->hash, &self->drive, &outputs);
    return outputs;
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

    return drive_command(&self->drive, command, error);
}

static void image_background(void *drive)
{
    struct instance *self = drive;

    drive_background(&self->drive);
}

static void image_signals(const void *drive, struct drive_signals *signals)
{
    const struct instance *self = drive;

    drive_signals_read(&self->drive, signals);
}

static uint64_t image_hash(const void *drive)
{
    const struct instance *self = drive;

    return self->hash;
}

/* firmware_image_<format>, visible outside the linked image. */
#define EXPORTED            __attribute__((visibility("default")))
#define PASTE(a, b)         a##b
#define IMAGE_OF(format)    PASTE(firmware_image_, format)
#define STRING(token)       #token
#define STRING_OF(expanded) STRING(expanded)

EXPORTED const struct firmware_image IMAGE_OF(NUM_FORMAT) = {
    .numeric = STRING_OF(NUM_FORMAT),
    .drive_bytes = sizeof(struct instance),
    .init = image_init,
    .control_cycle = image_control_cycle,
    .law_gain = image_law_gain,
    .command = image_command,
    .background = image_background,
    .signals = image_signals,
    .hash = image_hash,
};
