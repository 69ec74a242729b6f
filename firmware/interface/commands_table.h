/*
 * The commands of a drive and their parameters, declared once: a row each. From the rows follow
 * enum drive_command_kind and the members of struct drive_command, what is legal when
 * (drive/command_rules.h), what the console takes and says, what a scenario's events take, typed
 * lines and the page commands.md. To add a command: a row, and its act.
 *
 *   PARAMETER(index, member, unit, least, most, sentence)
 *   COMMAND(number, constant, name, required, optional, states, planning, sentence)
 *
 * - index: of the object dictionary (CiA 301); number: what is written to object 0x2200 to give the
 *   command. Neither ever changes or is used again.
 * - least, most: keep out what is absurd; the drive knows its own limits and says them.
 * - required, optional: sets of parameters, WITH(member).
 * - states: in which it is obeyed, ANY_STATE, OUTSIDE_FAULT, IN_OPERATION, READY_OR_DISABLED.
 * - planning: enum drive_planning without DRIVE_; with it stands where its act belongs.
 */
#ifndef STEADYSTEP_COMMANDS_TABLE_H
#define STEADYSTEP_COMMANDS_TABLE_H

#define DRIVE_PARAMETERS_TABLE(PARAMETER)                                                          \
    PARAMETER(0x2201, position_rad, "rad", -1e7, 1e7, "target, mechanical")                        \
    PARAMETER(0x2202, duration_s, "s", 1e-3, 600.0, "whole move, at least 2 ramp_s")               \
    PARAMETER(                                                                                     \
        0x2203, ramp_s, "s", 0.0, 600.0,                                                           \
        "one ramp of speed; a sine fades in and out in it, 0: begins and ends at full speed")      \
    PARAMETER(0x2204, jerk_s, "s", 0.0, 300.0,                                                     \
              "constant jerk at each end of a ramp, at most half of it")                           \
    PARAMETER(0x2205, amplitude_rad, "rad", -1e7, 1e7, "mechanical")                               \
    PARAMETER(0x2206, frequency_Hz, "Hz", 1e-3, 1e6,                                               \
              "at most a twentieth of the control frequency")                                      \
    PARAMETER(0x2207, cycles, "", 0.0, 1e9, "whole or half ones; 0: until a stop")                 \
    PARAMETER(0x2208, interval_s, "s", 1e-6, 1.0,                                                  \
              "between set-points, at least 3 control periods; rounded to whole ones")             \
    PARAMETER(0x2209, speed_rad_s, "rad/s", -1e5, 1e5,                                             \
              "signed; of a retarget or a torque the largest")                                     \
    PARAMETER(0x220a, acceleration_rad_s2, "rad/s2", 1e-6, 1e12, "largest")                        \
    PARAMETER(0x220b, jerk_rad_s3, "rad/s3", 1e-6, 1e15, "largest")                                \
    PARAMETER(0x220c, torque_Nm, "N m", -1e3, 1e3, "of the currents, signed")

#define DRIVE_COMMANDS_TABLE(COMMAND)                                                              \
    COMMAND(1, ENABLE, "enable", 0, 0, OUTSIDE_FAULT, IN_TURN,                                     \
            "offset calibration, then the hold that aligns the rotor, then ready")                 \
    COMMAND(2, DISABLE, "disable", 0, 0, ANY_STATE, URGENT, "opens the bridge; clears a fault")    \
    COMMAND(3, HOLD, "hold", 0, 0, IN_OPERATION, IN_TURN,                                          \
            "ramps the hold current in at the present reference")                                  \
    COMMAND(4, MOVE_TRAPEZOID, "move-trapezoid",                                                   \
            WITH(position_rad) | WITH(duration_s) | WITH(ramp_s), 0, IN_OPERATION, PROFILE,        \
            "trapezoid of speed")                                                                  \
    COMMAND(5, MOVE_SMOOTH, "move-smooth",                                                         \
            WITH(position_rad) | WITH(duration_s) | WITH(ramp_s) | WITH(jerk_s), 0, IN_OPERATION,  \
            PROFILE, "jerk-limited: ramps of speed with jerk_s of constant jerk at each end")      \
    COMMAND(6, STEP, "step", WITH(position_rad), 0, IN_OPERATION, PROFILE,                         \
            "the reference jumps to a position")                                                   \
    COMMAND(7, STOP, "stop", 0, 0, IN_OPERATION, URGENT, "brings the reference to rest")           \
    COMMAND(8, SINE, "sine", WITH(amplitude_rad) | WITH(frequency_Hz),                             \
            WITH(cycles) | WITH(ramp_s), IN_OPERATION, AHEAD,                                      \
            "about where the reference rests; cycles=0: until a stop")                             \
    COMMAND(9, SET_POINT, "set-point", WITH(position_rad),                                         \
            WITH(interval_s) | WITH(acceleration_rad_s2) | WITH(jerk_rad_s3), IN_OPERATION, AHEAD, \
            "the first begins a stream and needs all; the last position three times ends it")      \
    COMMAND(10, VELOCITY, "velocity",                                                              \
            WITH(speed_rad_s) | WITH(acceleration_rad_s2) | WITH(jerk_rad_s3), 0, IN_OPERATION,    \
            AHEAD, "a speed for ever, from whatever motion")                                       \
    COMMAND(11, RETARGET, "retarget",                                                              \
            WITH(position_rad) | WITH(speed_rad_s) | WITH(acceleration_rad_s2) |                   \
                WITH(jerk_rad_s3),                                                                 \
            0, IN_OPERATION, AHEAD, "to a position from whatever motion")                          \
    COMMAND(12, STORE, "store", 0, 0, ANY_STATE, AT_ONCE,                                          \
            "keeps settings and what was learned; not while a sine or "                            \
            "set-points go on")                                                                    \
    COMMAND(13, SET_POSITION, "set-position", WITH(position_rad), 0, READY_OR_DISABLED, IN_TURN,   \
            "the axis is at this position from now on, nothing moves; not in motion")              \
    COMMAND(14, TORQUE, "torque", WITH(torque_Nm), WITH(speed_rad_s), IN_OPERATION, IN_TURN,       \
            "with an encoder: a torque, up to a speed, from whatever motion")

#endif
