/*
 * The faults of a drive, declared once: a row each. From the rows follow enum drive_fault, the
 * names, what the console says of a fault and the page faults.md. To add a fault: a row, and what
 * raises it.
 *
 *   FAULT(constant, code, name, cause, limit, position, remedy)
 *
 * - code: error code of an emergency message, of CiA 301 and 402 (IEC 61800-7-201) where one means
 *   the same, else manufacturer specific (0xff00...); it never changes and is never used again.
 * - cause: the console says it. LIMIT(member): the value of this setting stands behind it.
 * - position: of the axis (drive/axis.h). STANDS: the fault says nothing of the rotor;
 *   WITH_ENCODER: without one the rotor may have left its place; UNCERTAIN: nor may an encoder
 *   count what the rotor does.
 * - remedy: what to do before the drive is disabled, which clears the fault, and enabled again.
 *
 * A trace has a fault as its place in this list: a new one is the last.
 */
#ifndef STEADYSTEP_FAULTS_TABLE_H
#define STEADYSTEP_FAULTS_TABLE_H

#define DRIVE_FAULTS_TABLE(FAULT)                                                                  \
    FAULT(OVERCURRENT, 0x2310, "overcurrent", "a phase current beyond", LIMIT(overcurrent_trip_A), \
          STANDS,                                                                                  \
          "check the motor's wiring, its resistance and inductance in the settings, and the "      \
          "current bandwidth")                                                                     \
    FAULT(HARDWARE_OVERCURRENT, 0x2320, "hardware-overcurrent",                                    \
          "the board's comparator has tripped", NO_LIMIT, STANDS,                                  \
          "look for a short circuit of motor, cable or bridge")                                    \
    FAULT(DEADLINE_MISSED, 0x6100, "deadline-missed", "a control interrupt has ended too late",    \
          NO_LIMIT, STANDS,                                                                        \
          "take a law or an estimator that needs less time; `cycles` shows the time used")         \
    FAULT(BUS_VOLTAGE, 0x3200, "bus-voltage", "the supply is outside 0.5...1.3 of",                \
          LIMIT(motor.supply_V), STANDS,                                                           \
          "set supply_V to the supply's voltage; a supply that rises while braking needs a brake " \
          "resistor or a slower ramp, one that sags more current")                                 \
    FAULT(ESTIMATE_RANGE, 0xff01, "estimate-range", "the estimate has lost the rotor", NO_LIMIT,   \
          UNCERTAIN,                                                                               \
          "check the motor's settings, speed_limit_rad_s and the load; move more gently")          \
    FAULT(                                                                                         \
        OFFSET_RANGE, 0x5210, "offset-range",                                                      \
        "a sensor's offset is too large to be one, or the rotor is being turned", NO_LIMIT,        \
        WITH_ENCODER,                                                                              \
        "let the rotor come to rest before enabling; if it was, current_offset_a_A and the three " \
        "signals behind it say which sensor to check")                                             \
    FAULT(POSITION_NOT_FOUND, 0x7122, "position-not-found",                                        \
          "no current flows, or the rotor has not followed the alignment, or not come to rest",    \
          NO_LIMIT, UNCERTAIN,                                                                     \
          "check that the motor is connected, free to turn by a step and not being turned, and "   \
          "that the settings have its inertia with the load's")                                    \
    FAULT(                                                                                         \
        LOST_SYNCHRONISM, 0x8611, "lost-synchronism",                                              \
        "the rotor is not where the estimate has it", NO_LIMIT, WITH_ENCODER,                      \
        "move more gently, or give more current; check initial angle and motor's settings, home "  \
        "the axis again")                                                                          \
    FAULT(STALLED, 0x7121, "stalled", "the rotor does not follow: overloaded, or held", NO_LIMIT,  \
          WITH_ENCODER,                                                                            \
          "free the axis or reduce the load, or raise current_limit_A; home the axis again")       \
    FAULT(PHASE_IMBALANCE, 0xff02, "phase-imbalance",                                              \
          "the phases differ by more than 15 %, or one of them carries no current", NO_LIMIT,      \
          STANDS,                                                                                  \
          "check both leads of each phase, that its resistance is the other's, and the current "   \
          "sensors")                                                                               \
    FAULT(FOLLOWING_ERROR, 0x8600, "following-error", "the rotor was off its reference by",        \
          LIMIT(following_error_rad), UNCERTAIN,                                                   \
          "free the axis, reduce the load or move more gently; check that the encoder counts, "    \
          "each turn all its counts, and in the rotor's direction")                                \
    FAULT(OPEN_PHASE_A, 0xff03, "open-phase-a", "no current flows", NO_LIMIT, WITH_ENCODER,        \
          "check both leads of phase a, and its current sensor")                                   \
    FAULT(OPEN_PHASE_B, 0xff04, "open-phase-b", "no current flows", NO_LIMIT, WITH_ENCODER,        \
          "check both leads of phase b, and its current sensor")                                   \
    FAULT(CURRENT_SENSOR_A, 0xff05, "current-sensor-a", "it is stuck", NO_LIMIT, WITH_ENCODER,     \
          "check shunt, amplifier and converter of phase a")                                       \
    FAULT(CURRENT_SENSOR_B, 0xff06, "current-sensor-b", "it is stuck", NO_LIMIT, WITH_ENCODER,     \
          "check shunt, amplifier and converter of phase b")                                       \
    FAULT(MOTOR_OVERHEATED, 0x2350, "motor-overheated", "its winding is too hot, for more than",   \
          LIMIT(motor.rated_current_A), STANDS,                                                    \
          "let it cool; move or hold with less current, or, if it bears more, correct "            \
          "rated_current_A and motor_time_constant_s")                                             \
    FAULT(BRIDGE_OVERHEATED, 0x4210, "bridge-overheated", "it has reached", LIMIT(bridge_fault_C), \
          STANDS, "let it cool; give it more air, or the motor less current")                      \
    FAULT(ENCODER, 0x7305, "encoder", "it miscounts", NO_LIMIT, UNCERTAIN,                         \
          "check the encoder, its cable and its supply; free the axis if it is held")              \
    FAULT(INDUCTANCE, 0xff07, "inductance", "it is not 0.65 to 1.6 of", LIMIT(motor.inductance_H), \
          STANDS, "correct inductance_H")                                                          \
    FAULT(VOLTAGE_SENSOR, 0xff08, "voltage-sensor",                                                \
          "a phase's voltage is measured far beside what was commanded", NO_LIMIT, WITH_ENCODER,   \
          "check the dividers of the legs and of the bus voltage, and that each leg switches")

#endif
