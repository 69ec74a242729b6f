#include "firmware/drive/law_design.h"

#include "firmware/drive/coefficients.h"

/* Gains given by name are the user's own: only their range is checked. */
static bool check_law_gains(const struct drive_settings *settings, char error[DRIVE_ERROR_TEXT])
{
    const struct law_gain_list list = position_law_gains(settings->law);

    for (size_t i = 0; i < DRIVE_LAW_GAINS; i++) {
        const double value = settings->law_gains[i];
        const bool given = value == value;

        if (given && i >= list.count) {
            return design_refuse(error, "law_gains: more are given than the law takes");
        }
        if (given && !(value >= list.gain[i].min && value <= list.gain[i].max)) {
            const bool low = value < list.gain[i].min;

            return design_refuse_limit(
                error, (struct refusal){.quantity = list.gain[i].name,
                                        .value = value,
                                        .relation = low ? "at least" : "at most",
                                        .limit = low ? list.gain[i].min : list.gain[i].max,
                                        .unit = "",
                                        .reason = "the range of this gain"});
        }
    }
    return true;
}

bool law_design(const struct drive *drive, const struct drive_settings *settings,
                union position_law_params *law, char error[DRIVE_ERROR_TEXT])
{
    const struct hal_facts *facts = drive->board->facts;
    const struct position_law_task task = {
        .motor = &settings->motor,
        .base = &drive->base,
        .period_s = facts->control_period_s,
        .delay_periods = facts->zero_delay ? 0u : 1u,
        .bandwidth_rad_s = settings->law_bandwidth_rad_s,
        .current_bandwidth_rad_s = settings->current_bandwidth_rad_s,
        .speed_limit_rad_s = settings->speed_limit_rad_s,
        .current_limit_A = settings->current_limit_A,
        .gains = settings->law_gains,
    };

    return check_law_gains(settings, error) &&
           position_law_design(settings->law, law, &task, error) &&
           coefficients_of_law_fit(settings->law, law, error);
}
