#include "firmware/drive/settings_in_motion.h"

#include "firmware/design/refusal.h"
#include "firmware/drive/board_limits.h"
#include "firmware/drive/default_settings.h"
#include "firmware/drive/law_design.h"
#include "firmware/drive/synchronism.h"
#include "firmware/interface/settings.h"

/* What an interrupt reads in one piece. */
typedef uint32_t __attribute__((may_alias)) word;

#define IN_WORDS(type) _Static_assert(sizeof(type) % sizeof(word) == 0, "written in words")

IN_WORDS(union position_law_params);
IN_WORDS(struct synchronism_monitor_params);

/* Those that differ: of a law's constants the limits, of which each acts for itself. */
static void put_words(void *in_force, const void *next, size_t bytes)
{
    volatile word *to = in_force;
    const word *from = next;

    for (size_t i = 0; i < bytes / sizeof *to; i++) {
        if (to[i] != from[i]) {
            to[i] = from[i];
        }
    }
}

static void put_number(volatile num_t *in_force, double value, double base)
{
    *in_force = num_from_double(value / base);
}

/* Wider first: no code of both ranges is ever beyond what is in force. */
static void put_range(volatile struct code_range *range, struct code_range next)
{
    if (next.width > range->width) {
        range->width = next.width;
        range->low = next.low;
    } else {
        range->low = next.low;
        range->width = next.width;
    }
}

/* What cannot change without a kink, or without a design of what it shapes. */
static bool check(const struct drive_settings *now, const struct drive_settings *next,
                  char error[DRIVE_ERROR_TEXT])
{
    const bool watched = now->synchronism_policy != DRIVE_SYNCHRONISM_OFF;

    if (watched != (next->synchronism_policy != DRIVE_SYNCHRONISM_OFF)) {
        return design_refuse(error, "synchronism_policy: to and from off while disabled");
    }
    if (next->law == POSITION_LAW_MICROSTEPPING && next->current_limit_A != now->current_limit_A) {
        return design_refuse(error, "current_limit_A: it is microstepping's current, set it while "
                                    "disabled");
    }
    if (next->standstill_pulses && next->overcurrent_trip_A != now->overcurrent_trip_A) {
        return design_refuse(error, "overcurrent_trip_A: it sizes standstill_pulses, set it while "
                                    "disabled");
    }
    return true;
}

static void put(volatile num_t *in_force, num_t value)
{
    *in_force = value;
}

void settings_in_motion_derate(struct drive *drive)
{
    struct drive_params *params = &drive->params;
    num_t *const of_law = position_law_current_limit(params->position_law, &params->law);
    const double set_A = drive->thermal.limit_A;
    const double base_A = drive->base.current_A;
    const num_t set = num_from_double(set_A / base_A);
    num_t left = thermal_watch_limit(&drive->thermal, set, params->hold.motion_current);

    if (of_law != NULL) {
        put(of_law, left);
        put(&drive->synchronism.params.full_current, num_mul_unit(left, UNIT(FULL_CURRENT)));
        drive->settings.current_limit_A = left < set ? num_to_double(left) * base_A : set_A;
    }
    if (params->hold.enters_at_rest) {
        left = thermal_watch_limit(&drive->thermal, set, params->hold.current);
    }
    put(&params->hold.current_limit, left);
}

bool settings_in_motion_change(struct drive *drive, const struct drive_settings *wanted,
                               char error[DRIVE_ERROR_TEXT])
{
    const struct hal_facts *facts = drive->board->facts;
    struct drive_params *params = &drive->params;
    struct synchronism_supervision *synchronism = &drive->synchronism;
    struct drive_settings next = drive->settings;
    union position_law_params law = params->law;
    struct default_settings_search none = {.refused = 0}; /* the hold's current is known */

    for (size_t i = 0; setting_number(i) != NULL; i++) {
        if (setting_number(i)->in_motion) {
            setting_put(&next, setting_number(i), 0, setting_get(wanted, setting_number(i), 0));
        }
    }
    (void)default_settings_step(&none, &next, facts->control_period_s,
                                facts->encoder_counts_per_turn);
    if (!board_limits_apply(&next, facts, error) || !check(&drive->settings, &next, error) ||
        !law_design(drive, &next, &law, error)) {
        return false;
    }
    put_words(&params->law, &law, sizeof law);
    put_number(&params->hold.current_limit, next.current_limit_A, drive->base.current_A);
    put_number(&params->hold.motion_current, next.motion_current_A, drive->base.current_A);
    put_range(&params->protection.current_codes,
              protection_design(&drive->base, facts, &next).current_codes);
    if (synchronism->monitored) {
        const struct synchronism_monitor_params monitor = synchronism_params(drive, &next);

        put_words(&synchronism->params, &monitor, sizeof monitor);
        synchronism->policy = next.synchronism_policy;
    }
    drive->settings = next;
    thermal_watch_set_limit(&drive->thermal, next.current_limit_A);
    if (drive->thermal.motor_in_force + drive->thermal.bridge_in_force > 0) {
        settings_in_motion_derate(drive);
    }
    return true;
}
