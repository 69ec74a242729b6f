#include "tests/one_step/rounded_drive.h"

#include "firmware/drive/drive.h"
#include "tests/one_step/rounding.h"

enum rounding_format rounding_format = ROUNDING_NONE;

/* xorshift64: the same draws on every machine. */
static uint64_t state = 88172645463325252u;

double rounding_between(double low, double high)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return low + (high - low) * ((double)(state >> 11) * (1.0 / 9007199254740992.0));
}

void rounded_control_cycle(void *drive, const struct hal_samples *samples,
                           enum rounding_format format, struct hal_outputs *outputs)
{
    rounding_format = format;
    drive_control_cycle(drive, samples, outputs);
}
