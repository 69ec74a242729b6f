#include "firmware/estimator/synchronism_monitor.h"

#include "firmware/design/elementary.h"

/* With a twentieth of the rated torque left a rotor that can move is faster than the bound within
   the time that it takes to be called standing. */
#define STANDING_S 14.4e-3
static const double standing_torque = 0.05;

/* Times of the rows below, in blocks. */
#define BLOCKS(time_s) ((int)((time_s) / SYNCHRONISM_BLOCK_S + 0.5))

enum {
    STANDING_BLOCKS = BLOCKS(STANDING_S),
    /* Moves that ask for more than the motor has are caught up with in half of this. */
    BEHIND_BLOCKS = BLOCKS(0.1),
    /* Twice what quick changes of load take to pass. */
    OPPOSITE_BLOCKS = BLOCKS(6.4e-3),
    PULL_OUT_BLOCKS = BLOCKS(3.2e-3),
    /* What motion has left unknown of the resistance is found in a hold within five times 22 ms. */
    SETTLED_BLOCKS = BLOCKS(0.11),
    WARNING_BLOCKS = BLOCKS(5e-3),
    DOUBTFUL_BLOCKS = BLOCKS(20e-3)
};

static num_t quarter(num_t x)
{
    return num_half(num_half(x));
}

static num_t eighth(num_t x)
{
    return num_half(quarter(x));
}

/* So many blocks of an unbroken row. */
static enum synchronism stalled_after(struct synchronism_monitor *monitor, uint32_t blocks_in_row,
                                      uint32_t limit)
{
    if (blocks_in_row < limit) {
        return SYNCHRONISM_SURE;
    }
    monitor->doubtful = DOUBTFUL_BLOCKS;
    return SYNCHRONISM_STALLED;
}

/* Of an unbroken row. */
static uint32_t count(uint32_t blocks_in_row, bool goes_on)
{
    return goes_on ? blocks_in_row + 1u : 0u;
}

/*
 * All from some thousand random runs of the motor bendjedia-2012 (campaign `slip`, 24 V). In none
 * that a drive has to live with does the disturbance come to half of what is allowed; within 20 ms
 * of a loss it comes to twice and more.
 */
static const double voltage_floor = 0.25 / 24.0; /* of the supply */
static const double settled_floor = 0.06 / 24.0;

/* Share of the magnet's flux Km/N by which the flux along d may change within a mean over eight
   blocks. Where the load grows by the rated torque in a tenth of a second, a rotor on its way to
   0.9 of what its hold bears leaves 0.17. */
static const double displaced_flux = 0.24;

/* Share of the resistance: what its adaptation leaves in a hold under load; all of it, where the
   bridge's switches and a winding of any temperature come on top of the motor's own. */
static const double resistance_error_known = 0.05;
static const double resistance_error_unknown = 0.75;

static const double pull_out_load = 1.6; /* of the rated torque */

static uint32_t block_periods(double period_s)
{
    const double count = SYNCHRONISM_BLOCK_S / period_s;

    return count > SYNCHRONISM_STEPS ? (uint32_t)(count + 0.5) : SYNCHRONISM_STEPS;
}

/* c over the periods of a block, for a share k_i of the innovation that is corrected in each. */
__attribute__((noinline)) static coef_t voltage_per_sum(const struct motor_model_params *model,
                                                        double current_gain, double periods)
{
    const double admittance = num_to_double(model->nominal_admittance);
    const double left = 1.0 - admittance * num_to_double(model->nominal_resistance); /* a */

    return coef_from_double((1.0 - (1.0 - current_gain) * left) / admittance / periods);
}

struct synchronism_monitor_params
synchronism_monitor_design(const struct synchronism_monitor_task *task)
{
    const struct motor_params *motor = task->motor;
    const struct per_unit *base = task->base;
    const uint32_t periods = block_periods(task->period_s);
    const double block_s = task->period_s * periods;
    const double resistance = num_to_double(task->model->nominal_resistance);
    const double rated_torque_Nm = motor->torque_constant_Nm_A * motor->rated_current_A;
    const double resistance_error =
        task->resistance_calibrated ? resistance_error_known : resistance_error_unknown;
    const double standing_rad_s =
        standing_torque * rated_torque_Nm / motor->inertia_kgm2 * STANDING_S;
    const double displaced_V =
        displaced_flux * motor->torque_constant_Nm_A / motor->rotor_teeth / (8.0 * block_s);
    /* A rotor that stands at full current is taken to turn so fast. */
    const double feigned_rad_s =
        task->resistance_calibrated ? 0.0
                                    : resistance_error_unknown * resistance * base->resistance_ohm *
                                          task->current_limit_A / motor->torque_constant_Nm_A;

    return (struct synchronism_monitor_params){
        .block_periods = periods,
        .voltage_per_sum_moving = voltage_per_sum(task->model, task->current_gain_moving, periods),
        .voltage_per_sum_holding =
            voltage_per_sum(task->model, task->current_gain_holding, periods),
        .voltage_per_current =
            coef_from_double(resistance * (task->resistance_adapted ? resistance_error_known
                                                                    : resistance_error_unknown)),
        .voltage_per_current_at_first = coef_from_double(resistance * resistance_error),
        .voltage_floor = num_from_double(voltage_floor * motor->supply_V / base->voltage_V),
        .settled_floor =
            num_from_double(larger(settled_floor * motor->supply_V, displaced_V) / base->voltage_V),
        .standing_speed_at_first =
            num_from_double((standing_rad_s + feigned_rad_s) / base->speed_rad_s),
        .standing_speed = num_from_double(standing_rad_s / base->speed_rad_s),
        .full_current = num_from_double(FULL_CURRENT * task->current_limit_A / base->current_A),
        .load_limit = num_from_double(pull_out_load * rated_torque_Nm / base->torque_Nm),
        .settled_blocks = task->resistance_adapted ? SETTLED_BLOCKS : UINT32_MAX,
    };
}

void synchronism_monitor_reset(struct synchronism_monitor *monitor,
                               const struct synchronism_monitor_params *params)
{
    *monitor = (struct synchronism_monitor){
        .voltage_per_current = params->voltage_per_current_at_first,
        .standing_speed = params->standing_speed_at_first,
    };
}

void synchronism_monitor_take(struct synchronism_monitor *monitor,
                              const struct synchronism_monitor_params *params, num_t innovation_sum,
                              bool holding)
{
    const coef_t *per_sum =
        holding ? &params->voltage_per_sum_holding : &params->voltage_per_sum_moving;
    const num_t mean = num_mul_coef(innovation_sum, *per_sum);

    monitor->disturbance = num_abs(num_half(mean + monitor->past_mean));
    monitor->past_mean = mean;
}

enum synchronism synchronism_monitor_judge_voltage(struct synchronism_monitor *monitor,
                                                   const struct synchronism_monitor_params *params,
                                                   num_t speed, num_t i_d)
{
    const num_t allowed = params->voltage_floor + quarter(num_abs(speed)) +
                          num_half(monitor->swing) +
                          num_mul_coef(num_abs(i_d), monitor->voltage_per_current);

    if (!(monitor->disturbance < allowed)) { /* a NaN is a loss, too */
        return SYNCHRONISM_LOST;
    }
    if (monitor->disturbance > num_half(allowed)) {
        monitor->doubtful = DOUBTFUL_BLOCKS;
    }
    return SYNCHRONISM_SURE;
}

static void begin_hold_anew(struct synchronism_monitor *monitor)
{
    monitor->held = 0u;
    monitor->settled = NUM(0.0);
    monitor->swing = NUM(0.0);
}

enum synchronism synchronism_monitor_judge_motion(struct synchronism_monitor *monitor,
                                                  const struct synchronism_monitor_params *params,
                                                  num_t speed, num_t i_d)
{
    const num_t magnitude = num_abs(speed);
    const num_t allowed =
        quarter(magnitude) + num_mul_coef(num_abs(i_d), monitor->voltage_per_current);

    begin_hold_anew(monitor);
    monitor->opposite = count(monitor->opposite, magnitude > params->standing_speed &&
                                                     !(monitor->disturbance < allowed));
    return monitor->opposite < OPPOSITE_BLOCKS ? SYNCHRONISM_SURE : SYNCHRONISM_LOST;
}

enum synchronism synchronism_monitor_judge_hold(struct synchronism_monitor *monitor,
                                                const struct synchronism_monitor_params *params,
                                                num_t speed, bool leads)
{
    monitor->opposite = 0u;
    if (leads) { /* away from the angle at which the offset along d passed for a resistance */
        begin_hold_anew(monitor);
        return SYNCHRONISM_SURE;
    }
    monitor->swing += eighth(num_abs(speed) - monitor->swing);
    if (monitor->held < params->settled_blocks) {
        monitor->held++;
        return SYNCHRONISM_SURE;
    }
    monitor->voltage_per_current = params->voltage_per_current;
    monitor->standing_speed = params->standing_speed;
    monitor->settled += eighth(monitor->past_mean - monitor->settled);

    const num_t allowed = params->settled_floor + quarter(monitor->swing);

    if (num_abs(monitor->settled) > num_half(allowed)) {
        monitor->doubtful = DOUBTFUL_BLOCKS;
    }
    return num_abs(monitor->settled) < allowed ? SYNCHRONISM_SURE : SYNCHRONISM_LOST;
}

/* A rotor that rests in its hold does what it is to do. */
static bool rests(const struct synchronism_monitor *monitor,
                  const struct synchronism_monitor_params *params, num_t speed)
{
    return monitor->held > 0u && speed <= params->settled_floor;
}

enum synchronism synchronism_monitor_judge_torque(struct synchronism_monitor *monitor,
                                                  const struct synchronism_monitor_params *params,
                                                  num_t wanted, num_t speed)
{
    const num_t magnitude = num_abs(speed);

    monitor->full = num_abs(wanted) > params->full_current;
    monitor->standing =
        count(monitor->standing, RARE(monitor->full) && magnitude < monitor->standing_speed &&
                                     !rests(monitor, params, magnitude));
    return stalled_after(monitor, monitor->standing, STANDING_BLOCKS);
}

enum synchronism synchronism_monitor_judge_load(struct synchronism_monitor *monitor,
                                                const struct synchronism_monitor_params *params,
                                                num_t load_torque)
{
    const num_t load = num_abs(load_torque);

    monitor->pull_out = count(monitor->pull_out, load > params->load_limit);
    return stalled_after(monitor, monitor->pull_out, PULL_OUT_BLOCKS);
}

/* The load angle at which the current that holds a rotor yields, electrical turns. */
#define PULL_OUT_ANGLE NUM(0.25)

enum synchronism
synchronism_monitor_judge_following(struct synchronism_monitor *monitor,
                                    const struct synchronism_monitor_params *params, num_t error,
                                    num_t deficit)
{
    const num_t opening = error < NUM(0.0) ? -deficit : deficit;

    monitor->behind = count(monitor->behind, monitor->full && num_abs(error) > PULL_OUT_ANGLE &&
                                                 opening > -params->standing_speed);
    return stalled_after(monitor, monitor->behind, BEHIND_BLOCKS);
}

enum synchronism synchronism_monitor_judge_pull_out(struct synchronism_monitor *monitor,
                                                    num_t error)
{
    const num_t load_angle = num_abs(error);

    if (load_angle > num_half(PULL_OUT_ANGLE)) {
        monitor->doubtful = DOUBTFUL_BLOCKS;
    }
    return load_angle > PULL_OUT_ANGLE ? SYNCHRONISM_STALLED : SYNCHRONISM_SURE;
}

enum synchronism synchronism_monitor_judge_load_angle(struct synchronism_monitor *monitor)
{
    if (monitor->behind >= WARNING_BLOCKS || monitor->standing >= WARNING_BLOCKS) {
        monitor->doubtful = DOUBTFUL_BLOCKS;
    }
    if (monitor->doubtful == 0u) {
        return SYNCHRONISM_SURE;
    }
    monitor->doubtful--;
    return SYNCHRONISM_DOUBTFUL;
}
