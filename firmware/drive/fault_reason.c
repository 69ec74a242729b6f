#include "firmware/drive/fault_reason.h"

enum { DIGITS = 6 };

void fault_reason_put(struct text *text, const struct drive *drive)
{
    const enum drive_fault fault = drive->fault;

    text_put(text, drive_fault_name(fault));
    switch (fault) {
    case DRIVE_FAULT_OVERCURRENT:
        text_put(text, ": a phase current beyond ");
        text_number(text, drive->settings.overcurrent_trip_A, DIGITS);
        text_put(text, " A");
        break;
    case DRIVE_FAULT_HARDWARE_OVERCURRENT:
        text_put(text, ": the board's comparator has tripped");
        break;
    case DRIVE_FAULT_DEADLINE_MISSED:
        text_put(text, ": a control interrupt has ended too late");
        break;
    case DRIVE_FAULT_BUS_VOLTAGE:
        text_put(text, ": the supply is outside 0.5...1.3 of ");
        text_number(text, drive->settings.motor.supply_V, DIGITS);
        text_put(text, " V");
        break;
    case DRIVE_FAULT_ESTIMATE_RANGE:
        text_put(text, ": the estimate has lost the rotor");
        break;
    case DRIVE_FAULT_OFFSET_RANGE:
        text_put(text, ": a sensor's offset is too large to be one, or the rotor is being turned");
        break;
    case DRIVE_FAULT_LOST_SYNCHRONISM:
        text_put(text, ": the rotor is not where the estimate has it");
        break;
    case DRIVE_FAULT_STALLED:
        text_put(text, ": the rotor does not follow: overloaded, or held");
        break;
    case DRIVE_FAULT_POSITION_NOT_FOUND:
        text_put(
            text,
            ": no current flows, or the rotor has not followed the alignment, or not come to rest");
        break;
    default:
        break;
    }
}
