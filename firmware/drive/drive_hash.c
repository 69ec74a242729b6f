#include "firmware/drive/drive_hash.h"

#include "firmware/drive/drive.h"

static uint64_t hash_coefs(uint64_t hash, const coef_t *coefs, size_t bytes)
{
    for (size_t i = 0; i < bytes / sizeof *coefs; i++) {
        hash = drive_hash_word(hash, coef_bits(coefs[i]));
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
        hash = drive_hash_word(hash, byte[i]);
    }
    return hash;
}

static uint64_t hash_estimator(uint64_t hash, const struct estimator_params *p)
{
    switch (p->kind) {
    case ESTIMATOR_INVARIANT_EKF:
        hash = HASH_RANGE(hash, p->invariant_ekf.moving, current, load_settle);
        hash = HASH_RANGE(hash, p->invariant_ekf.holding, current, load_settle);
        hash = HASH_RANGE(hash, p->invariant_ekf.unloaded, current, load_settle);
        return HASH_RANGE(hash, p->invariant_ekf.following, current, load_settle);
    case ESTIMATOR_STEADY_STATE_EKF:
        return HASH_RANGE(hash, p->steady_state_ekf, rotation, gain_load);
    case ESTIMATOR_HIGH_GAIN_OBSERVER:
        hash = HASH_RANGE(hash, p->high_gain_observer, transition[0][0], acceleration_per_turn);
        break;
    case ESTIMATOR_ENCODER_OBSERVER:
        break;
    }
    return HASH_RANGE(hash, p->encoder_observer, gain_angle, gain_resistance);
}

uint64_t drive_hash_gains(const struct drive_params *p)
{
    uint64_t hash = UINT64_C(0xcbf29ce484222325); /* offset basis of FNV-1a */

    hash = HASH_RANGE(hash, p->measurement, current, bus_voltage);
    hash = HASH_RANGE(hash, p->model, rate, admittance_per_resistance);
    hash = hash_estimator(hash, &p->estimator);
    hash = HASH_RANGE(hash, p->reference, speed, jerk);
    hash = hash_law(hash, p);
    hash = HASH_RANGE(hash, p->current_control, proportional, reactance);
    hash = drive_hash_word(hash, coef_bits(p->hold.damping));
    return drive_hash_word(hash, coef_bits(p->modulator.counts));
}

struct drive_hash_row drive_hash_row(const struct drive *drive, const struct hal_outputs *outputs)
{
    const uint16_t *high = outputs->high_counts;
    const struct rotor *rotor = &drive->estimator.estimate.rotor;

    return (struct drive_hash_row){{
        ((uint32_t)high[0] << 16) | high[1],
        ((uint32_t)high[2] << 16) | high[3],
        ((uint32_t)drive->supervision.state << 1) | (outputs->bridge_on ? 1u : 0u),
        (uint32_t)rotor->position.turns,
        rotor->position.fraction,
        num_bits(rotor->speed),
        num_bits(rotor->load_torque),
        num_bits(drive->current.d),
        num_bits(drive->current.q),
    }};
}
