#include "firmware/drive/parameter_store.h"

#include "firmware/drive/record_log.h"

enum { PAYLOAD_BYTES = 4 * DRIVE_DETENT_COEFFICIENTS };

static const struct record_log log_of_learned = {
    .first_page = 0, .format = 1, .payload_bytes = PAYLOAD_BYTES};

/* A coefficient is kept in 32 bits: +-215 N m. */
static const double resolution_Nm = 1e-7;

static int32_t in_steps(double torque_Nm)
{
    const double steps = torque_Nm / resolution_Nm;

    if (!(steps > -2147483647.0)) {
        return -INT32_MAX;
    }
    return steps < 2147483647.0 ? (int32_t)(steps + (steps < 0.0 ? -0.5 : 0.5)) : INT32_MAX;
}

bool parameter_store_read(const struct hal *board, struct learned_parameters *learned)
{
    uint8_t slot[RECORD_SLOT_BYTES(PAYLOAD_BYTES)];

    if (!record_log_read(board, &log_of_learned, slot)) {
        return false;
    }
    for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++) {
        const uint32_t steps = (uint32_t)record_get(&slot[RECORD_HEADER_BYTES + 4 * i], 4);

        learned->detent_torque_Nm[i] = (double)(int32_t)steps * resolution_Nm;
    }
    return true;
}

bool parameter_store_write(const struct hal *board, const struct learned_parameters *learned)
{
    uint8_t slot[RECORD_SLOT_BYTES(PAYLOAD_BYTES)];

    for (int i = 0; i < DRIVE_DETENT_COEFFICIENTS; i++) {
        const int32_t steps = in_steps(learned->detent_torque_Nm[i]);

        record_put(&slot[RECORD_HEADER_BYTES + 4 * i], (uint32_t)steps, 4);
    }
    return record_log_write(board, &log_of_learned, slot) != RECORD_REFUSED;
}
