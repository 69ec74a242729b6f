/* What of the application the control interrupt runs; all else is background or start-up. */
#include "firmware/application/application.h"
#include "firmware/linkage.h"

CALLED_FROM_OUTSIDE const struct hal_outputs *
application_control_interrupt(struct application *application, const struct hal_samples *samples)
{
    drive_control_cycle(&application->drive, samples, &application->outputs);
    return &application->outputs;
}
