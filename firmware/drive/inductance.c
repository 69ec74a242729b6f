#include "firmware/drive/inductance.h"

#include "firmware/drive/drive.h"
#include "firmware/numeric/quotient.h"

/*
 * What iron takes of an inductance is not known better than this: one that is nearer is that of the
 * settings. Of iron that takes nothing 4 % too much has been added (inductance_measurement.c).
 */
#define CONFIRMED_BELOW NUM(-0.03)
#define CONFIRMED_ABOVE NUM(0.075)

/* Sets of gains: of motion, of the hold, of that without a load, of what follows one. The model
   comes into force before them. */
enum { GAIN_SETS = 4, PARTS = GAIN_SETS + 1 };

/* At once: of what is in force. */
#define MORE_MAX NUM(0.65)

static void scale_gains(struct invariant_ekf_gain_set *gain, num_t more)
{
    gain->speed_q = coef_more(gain->speed_q, more);
    gain->angle_d = coef_more(gain->angle_d, more);
    gain->angle_q = coef_more(gain->angle_q, more);
    gain->load_q = coef_more(gain->load_q, more);
    gain->bias_q = coef_more(gain->bias_q, more);
    gain->resistance = coef_more(gain->resistance, more);
}

static void scale_model(struct motor_model_params *model, num_t less)
{
    const coef_t per_resistance = coef_more(model->admittance_per_resistance, less);

    model->rate = coef_more(model->rate, less);
    model->admittance_per_resistance = coef_more(per_resistance, less);
    model->nominal_admittance += num_mul(model->nominal_admittance, less);
}

static void scale_current_control(struct current_control_params *control,
                                  const struct inductance_put *put)
{
    control->proportional = coef_more(control->proportional, put->more);
    control->reactance = coef_more(control->reactance, put->more);
    control->unwind = coef_more(control->unwind, put->less);
}

void inductance_put_part(struct drive *drive)
{
    struct inductance_put *put = &drive->enabling.inductance_put;
    struct drive_params *params = &drive->params;
    struct invariant_ekf_params *ekf = &params->estimator.invariant_ekf;
    struct winding *winding = &drive->estimator.estimate.winding;
    struct invariant_ekf_gain_set *const gains[GAIN_SETS] = {&ekf->moving, &ekf->holding,
                                                             &ekf->unloaded, &ekf->following};

    put->left--;
    if (put->left < GAIN_SETS) {
        scale_gains(gains[put->left], put->more);
        return;
    }
    scale_current_control(&params->current_control, put);
    scale_model(&params->model, put->less);
    ekf->model = params->model;
    winding_set_resistance(winding, &params->model, winding->resistance);
}

bool inductance_put(struct drive *drive, num_t more)
{
    const num_t before = drive->enabling.inductance_change;
    const num_t found = before + more + num_mul(before, more);

    if (num_abs(more) > MORE_MAX || found < NUM(-INDUCTANCE_LESS_MAX) ||
        found > NUM(INDUCTANCE_MORE_MAX)) {
        return false;
    }
    const bool confirmed = found > CONFIRMED_BELOW && found < CONFIRMED_ABOVE;

    drive->enabling.inductance_change = confirmed ? NUM(0.0) : found;
    const num_t by = confirmed ? before : more;
    const num_t back = quotient(-by, NUM(1.0) + by); /* 1 / (1 + by) - 1 */

    drive->enabling.inductance_put = (struct inductance_put){
        .more = confirmed ? back : by, .less = confirmed ? by : back, .left = PARTS};
    return true;
}

double inductance_in_force_H(const struct drive *drive)
{
    return drive->settings.motor.inductance_H *
           (1.0 + num_to_double(drive->enabling.inductance_change));
}
