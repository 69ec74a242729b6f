#include "firmware/drive/coefficients.h"

#include "firmware/design/text.h"

/* The law's, where it is linear in the errors; NULL: it is not. */
static const struct error_feedback_params *
error_feedback_of(enum position_law law, const union position_law_params *params)
{
    switch (law) {
    case POSITION_LAW_STATE_FEEDBACK:
        return &params->state_feedback.feedback;
    case POSITION_LAW_PID:
        return &params->pid.feedback;
    case POSITION_LAW_STMMS:
        return &params->stmms.demand.feedback;
    case POSITION_LAW_STMMS_PLUS:
        return &params->stmms_plus.demand.feedback;
    case POSITION_LAW_FOC:
        return &params->foc.demand.feedback;
    default:
        return NULL;
    }
}

static void show_law(enum position_law law, const union position_law_params *params,
                     coefficient_viewer *view, void *context)
{
    const struct error_feedback_params *feedback = error_feedback_of(law, params);

    if (feedback != NULL) {
        error_feedback_params_show_coefficients(feedback, view, context);
    }
}

static void show_estimator(const struct estimator_params *params, coefficient_viewer *view,
                           void *context)
{
    const struct invariant_ekf_params *ekf = &params->invariant_ekf;
    const struct invariant_ekf_gain_set *const sets[] = {&ekf->moving, &ekf->holding,
                                                         &ekf->unloaded, &ekf->following};

    if (!estimator_is(params, ESTIMATOR_INVARIANT_EKF)) {
        return;
    }
    for (size_t i = 0; i < sizeof sets / sizeof sets[0]; i++) {
        invariant_ekf_gain_set_show_coefficients(sets[i], view, context);
    }
}

/* All but the law's. */
static void show_drive(const struct drive_params *params, coefficient_viewer *view, void *context)
{
    measurement_params_show_coefficients(&params->measurement, view, context);
    motor_model_params_show_coefficients(&params->model, view, context);
    show_estimator(&params->estimator, view, context);
    reference_params_show_coefficients(&params->reference, view, context);
    standstill_hold_params_show_coefficients(&params->hold, view, context);
    current_control_params_show_coefficients(&params->current_control, view, context);
    modulator_params_show_coefficients(&params->modulator, view, context);
}

void coefficients_show(const struct drive *drive, coefficient_viewer *view, void *context)
{
    show_drive(&drive->params, view, context);
    show_law(drive->params.position_law, &drive->params.law, view, context);
}

#ifdef STEADYSTEP_COEFFICIENT_SHIFTS

/* Of a mantissa. What is learned in operation, 65 % of the inductance (inductance.c), moves the
   drive's; a law's moves with a design. */
#define MOST_OF_DRIVE (INT16_MAX / 1.7)
#define MOST_OF_LAW   (INT16_MAX - 1.0) /* a larger number has become INT16_MAX */

struct fit {
    double most;
    bool fits;
    char *error;
};

/* A mantissa that has become INT16_MAX stands for any larger one. */
static void fit_one(void *context, const char *name, coef_t coefficient)
{
    struct fit *fit = context;
    const double mantissa = coefficient.mantissa;
    const double size = mantissa < 0.0 ? -mantissa : mantissa;

    if (fit->fits && size > fit->most) {
        struct text text = text_in(fit->error, DRIVE_ERROR_TEXT);
        const double value = coef_to_double(coefficient);
        const double magnitude = value < 0.0 ? -value : value;

        text_put(&text, name[0] != '\0' ? name : "a coefficient");
        text_put(&text, " ");
        text_number(&text, magnitude, 4);
        text_put(&text, size < INT16_MAX ? ": must be at most " : " or more: must be at most ");
        text_number(&text, magnitude * fit->most / size, 4);
        text_put(&text, ", by the shifts of this image, which is for one motor");
        fit->fits = false;
    }
}

bool coefficients_fit(const struct drive *drive, char error[DRIVE_ERROR_TEXT])
{
    struct fit fit = {MOST_OF_DRIVE, true, error};

    show_drive(&drive->params, fit_one, &fit);
    return fit.fits;
}

bool coefficients_of_law_fit(enum position_law law, const union position_law_params *params,
                             char error[DRIVE_ERROR_TEXT])
{
    struct fit fit = {MOST_OF_LAW, true, error};

    show_law(law, params, fit_one, &fit);
    return fit.fits;
}

#endif
