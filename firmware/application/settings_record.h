/*
 * The settings of a drive as a record in the parameter store, pages 2 and 3 (drive/record_log.h,
 * format 0x5303). Independent of number format, compiler and layout of structs: every field stands
 * at its own place, little-endian, a real number as the 64 bits of its IEEE 754 double. What comes
 * back is what went in, bit for bit.
 *
 *   payload     0   motor, a double each: resistance_ohm, inductance_H, torque_constant_Nm_A,
 *                   viscous_friction_Nms_rad, inertia_kgm2, rated_current_A, supply_V
 *              56   rotor_teeth of the motor, 4 bytes
 *              60   encoder counts per turn of the board, 4 bytes; 0: none
 *              64   law (position_laws.h), 1 byte; then from drive_interface.h, 1 byte each:
 *              65   feedback, estimator, observer, voltage_source, initial_position,
 *                   synchronism_policy; one byte free
 *              72   flags, 8 bytes; from bit 0 on: feed_forward, detent_learning,
 *                   bridge_loss_compensation, resistance_adaptation, encoder_zero_known,
 *                   calibrate_offsets, hold_on_enable, hold_at_rest, standstill_pulses
 *              80   a double each: law_bandwidth_rad_s, current_bandwidth_rad_s, current_limit_A,
 *                   overcurrent_trip_A, speed_limit_rad_s, observer_bandwidth_rad_s,
 *                   high_gain_epsilon_s, encoder_zero_rad, initial_load_torque_Nm,
 *                   hold_on_enable_s, hold_current_A, hold_ramp_s, hold_delay_s,
 *                   hold_bandwidth_rad_s, initial_angle_rad, initial_angle_error_rad,
 *                   motion_current_A
 *             216   law_gains, 12 doubles; NaN: not given
 *             312   detent_torque_Nm, 6 doubles
 */
#ifndef STEADYSTEP_SETTINGS_RECORD_H
#define STEADYSTEP_SETTINGS_RECORD_H

#include "firmware/drive/drive_interface.h"
#include "firmware/drive/record_log.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    SETTINGS_RECORD_FIRST_PAGE = 2,
    SETTINGS_RECORD_FORMAT = 0x5303,
    SETTINGS_RECORD_PAYLOAD = 360,
    SETTINGS_RECORD_BYTES = RECORD_BYTES(SETTINGS_RECORD_PAYLOAD)
};

/* What is kept. */
struct stored_settings {
    struct drive_settings drive;
    uint32_t encoder_counts_per_turn; /* of the encoder at the board; 0: none */
};

/* The whole record, header and checksum included; a store takes it at the begin of page 2. */
void settings_record_encode(const struct stored_settings *settings, uint32_t sequence,
                            uint8_t record[SETTINGS_RECORD_BYTES]);

/* false: no record of this format, harmed, or a law or feedback that this firmware does not know.
 */
bool settings_record_decode(struct stored_settings *settings,
                            const uint8_t record[SETTINGS_RECORD_BYTES]);

/* The newest record in the board's store. false: there is none; `settings` is not touched. */
bool settings_record_read(const struct hal *board, struct stored_settings *settings);

/* Background, up to 35 ms. false: the board has no store, or refused to write; the record before
   remains. */
bool settings_record_write(const struct hal *board, const struct stored_settings *settings);

#ifdef __cplusplus
}
#endif

#endif
