#include "firmware/drive/board_limits.h"

#include "firmware/control/modulation_limit.h"
#include "firmware/design/elementary.h"
#include "firmware/design/refusal.h"
#include "firmware/design/text.h"

enum { REASON_TEXT = 100, DIGITS = 4 };

static double current_range_A(const struct hal_facts *facts)
{
    return BOARD_CURRENT_RANGE_A((int32_t)facts->converter_codes, facts->current_zero_code,
                                 facts->current_A_per_code);
}

/* "<before><range> <unit><behind>" is the reason. */
static bool refuse(const char *quantity, double value, double limit, const char *unit,
                   const char *before, double range, const char *behind,
                   char error[DRIVE_ERROR_TEXT])
{
    char reason[REASON_TEXT];
    struct text text = text_in(reason, sizeof reason);

    text_put(&text, before);
    text_number(&text, range, DIGITS);
    text_put(&text, " ");
    text_put(&text, unit);
    text_put(&text, behind);
    return design_refuse_limit(error, (struct refusal){.quantity = quantity,
                                                       .value = value,
                                                       .relation = "at most",
                                                       .limit = limit,
                                                       .unit = unit,
                                                       .reason = reason});
}

static bool check_supply(double supply_V, const struct hal_facts *facts,
                         char error[DRIVE_ERROR_TEXT])
{
    const double limit_V = BOARD_SUPPLY_LIMIT_V(facts->converter_codes, facts->bus_V_per_code);

    return supply_V <= limit_V ||
           refuse("supply_V", supply_V, limit_V, "V",
                  "over-voltage is 1.29 times as much, and the board measures up to ",
                  (double)(facts->converter_codes - 1u) * facts->bus_V_per_code, "", error);
}

static bool check_rated_current(double rated_A, double range_A, char error[DRIVE_ERROR_TEXT])
{
    const double limit_A = RATED_CURRENT_SHARE * range_A;

    return rated_A <= limit_A || refuse("rated_current_A", rated_A, limit_A, "A", "0.8 of the +-",
                                        range_A, " that the board measures", error);
}

static bool check_current_limit(double current_A, double range_A, char error[DRIVE_ERROR_TEXT])
{
    const double limit_A = CURRENT_LIMIT_SHARE * range_A;

    return current_A <= limit_A ||
           refuse("current_limit_A", current_A, limit_A, "A", "0.98 of the +-", range_A,
                  " that the board measures", error);
}

static bool check_low_state(const struct hal_facts *facts, char error[DRIVE_ERROR_TEXT])
{
    const double limit_s = 0.5 * (1.0 - MODULATION_MAX_LEAST) * facts->control_period_s;

    return facts->low_state_s <= limit_s ||
           refuse("low_state_s", facts->low_state_s, limit_s, "s",
                  "a fifth of the control period, ", facts->control_period_s, "", error);
}

bool board_limits_apply(struct drive_settings *settings, const struct hal_facts *facts,
                        char error[DRIVE_ERROR_TEXT])
{
    const double rated_A = settings->motor.rated_current_A;
    const double range_A = current_range_A(facts);
    const bool trip_given = settings->overcurrent_trip_A == settings->overcurrent_trip_A;
    /* a limit equal to the rated current is its default: what was given is the motor */
    const bool limit_given =
        settings->current_limit_A < rated_A || settings->current_limit_A > rated_A;

    if (!trip_given) {
        settings->overcurrent_trip_A =
            smaller(OVERCURRENT_SHARE * rated_A, CURRENT_LIMIT_SHARE * range_A);
    }
    return check_low_state(facts, error) && check_supply(settings->motor.supply_V, facts, error) &&
           (limit_given ? check_current_limit(settings->current_limit_A, range_A, error)
                        : check_rated_current(rated_A, range_A, error)) &&
           (settings->overcurrent_trip_A <= range_A ||
            refuse("overcurrent_trip_A", settings->overcurrent_trip_A, range_A, "A",
                   "the board measures +-", range_A, "", error));
}

__attribute__((noinline)) double default_speed_limit_rad_s(const struct motor_params *motor)
{
    return SPEED_LIMIT_SHARE * motor->supply_V / motor->torque_constant_Nm_A;
}

/* The largest modulation of the supply = R i + |Km w + R Kv w / Km + j N w L i|. */
static double supplied_speed_rad_s(const struct motor_params *motor, const struct hal_facts *facts,
                                   double current_A)
{
    const double modulation = modulation_max(facts->low_state_s, facts->control_period_s);
    const double friction_Vs =
        motor->resistance_ohm * motor->viscous_friction_Nms_rad / motor->torque_constant_Nm_A;
    const double along_Vs = motor->torque_constant_Nm_A + friction_Vs;
    const double across_Vs = motor->rotor_teeth * motor->inductance_H * current_A;

    return (modulation * motor->supply_V - motor->resistance_ohm * current_A) /
           square_root(along_Vs * along_Vs + across_Vs * across_Vs);
}

/* In single precision, which the core computes by itself. */
struct supplied_current board_limits_current(const struct drive_settings *settings,
                                             const struct hal_facts *facts, float speed_rad_s)
{
    const struct motor_params *motor = &settings->motor;
    const float supply_V =
        (float)motor->supply_V * (float)modulation_max(facts->low_state_s, facts->control_period_s);
    const float resistance_ohm = (float)motor->resistance_ohm;
    const float emf_V = (float)motor->torque_constant_Nm_A * speed_rad_s;
    const float across_ohm = (float)motor->rotor_teeth * (float)motor->inductance_H * speed_rad_s;
    const float impedance_ohm2 = resistance_ohm * resistance_ohm + across_ohm * across_ohm;
    const float left =
        impedance_ohm2 * supply_V * supply_V - across_ohm * across_ohm * emf_V * emf_V;
    const float both_A = (float)square_root((double)left) / impedance_ohm2; /* 0: nothing is left */
    const float drop_A = both_A > 0.0f ? resistance_ohm * emf_V / impedance_ohm2 : 0.0f;

    return (struct supplied_current){.accelerating_A = both_A > drop_A ? both_A - drop_A : 0.0f,
                                     .braking_A = both_A + drop_A};
}

__attribute__((noinline)) double no_load_speed_rad_s(const struct drive_settings *settings,
                                                     const struct hal_facts *facts)
{
    return smaller(settings->speed_limit_rad_s, supplied_speed_rad_s(&settings->motor, facts, 0.0));
}

/*
 * Without an encoder a rotor that lags for want of voltage is lost: there the supply has to drive
 * the current of a default ramp, too, a quarter of the rated one, and a tenth for friction. Its
 * voltage is taken as if it were along that of the speed, which is rather too much.
 */
#define RAMP_CURRENT_SHARE 0.35

/* What is sampled ends at 0.24 turns a period (drive.c); a rotor swings about its reference. */
#define SAMPLED_TURNS 0.2

struct speed_limit board_limits_speed(const struct drive_settings *settings,
                                      const struct hal_facts *facts)
{
    const double sampled_rad_s =
        SAMPLED_TURNS * 6.283185307179586 / (settings->motor.rotor_teeth * facts->control_period_s);
    const double current_A = settings->feedback == DRIVE_FEEDBACK_SENSORLESS
                                 ? RAMP_CURRENT_SHARE * settings->motor.rated_current_A
                                 : 0.0;
    const double supplied_rad_s = supplied_speed_rad_s(&settings->motor, facts, current_A);
    const double default_rad_s = default_speed_limit_rad_s(&settings->motor);
    const bool widened = settings->speed_limit_rad_s > default_rad_s;
    struct speed_limit limit = {settings->speed_limit_rad_s, "limit of the drive"};

    if (!widened && supplied_rad_s < limit.rad_s) {
        limit = (struct speed_limit){supplied_rad_s, "where the back-EMF takes up the supply"};
    }
    if (sampled_rad_s < limit.rad_s) {
        limit = (struct speed_limit){sampled_rad_s, "a fifth of an electrical turn in a period"};
    }
    return limit;
}

__attribute__((noinline)) double drive_blind_speed_rad_s(const struct drive_settings *settings,
                                                         const struct hal_facts *facts)
{
    const double offset_A = facts->current_offset_codes * facts->current_A_per_code;
    const double resistance_ohm = settings->motor.resistance_ohm + facts->bridge_resistance_ohm;

    return settings->feedback == DRIVE_FEEDBACK_ENCODER
               ? 0.0
               : offset_A * resistance_ohm / settings->motor.torque_constant_Nm_A;
}
