/*
 * The signals of a drive, declared once: a row each. From the rows follow the members of struct
 * drive_signals, where they come from (drive_signals_read, and the map of an image for the virtual
 * board), the console's `signals` and `state`, the drive's columns of a trace and the page
 * signals.md. To add a signal: a row.
 *
 *   FLAG(index, member, path, brief, traced, sentence)
 *   COUNT(index, member, path, brief, traced, sentence)          a whole number
 *   ANGLE(index, member, path, brief, traced, sentence)          a position, in rad: the user's
 *   NAMED(index, member, path, brief, traced, type, sentence)    of an enumeration
 *   REAL(index, member, path, brief, traced, base, unit, sentence)
 *
 * - index: of the object dictionary, the standard's where one means the same (CiA 402), else
 *   manufacturer specific; it never changes and is never used again.
 * - path: from struct drive (drive/drive.h); base: the member of struct per_unit that it is in.
 * - brief: under which `state` shows it, "": only `signals` does.
 * - traced: TRACED, a column of trace.csv, of which a new one is the last; or UNTRACED.
 */
#ifndef STEADYSTEP_SIGNALS_TABLE_H
#define STEADYSTEP_SIGNALS_TABLE_H

#define DRIVE_SIGNALS_TABLE(FLAG, COUNT, ANGLE, NAMED, REAL)                                       \
    NAMED(0x2300, state, supervision.state, "", TRACED, drive_state,                               \
          "of the state machine, as CiA 402 names")                                                \
    NAMED(0x603f, fault, supervision.fault, "fault", TRACED, drive_fault,                          \
          "why the bridge was opened; on a fieldbus its code")                                     \
    COUNT(0x2301, period, supervision.period, "period", UNTRACED,                                  \
          "index k of the control interrupt")                                                      \
    ANGLE(0x2310, theta_est_rad, estimator.estimate.rotor.position, "position_rad", TRACED,        \
          "estimate of the rotor's position")                                                      \
    REAL(0x2311, omega_est_rad_s, estimator.estimate.rotor.speed, "speed_rad_s", TRACED,           \
         speed_rad_s, "rad/s", "estimate of its speed")                                            \
    REAL(0x2312, load_torque_est_Nm, estimator.estimate.rotor.load_torque, "load_torque_Nm",       \
         TRACED, torque_Nm, "N m", "estimate of the load on it")                                   \
    ANGLE(0x2313, theta_ref_rad, reference.now.position, "reference_rad", TRACED,                  \
          "reference theta*(k)")                                                                   \
    REAL(0x2314, omega_ref_rad_s, reference.now.speed, "reference_rad_s", TRACED, speed_rad_s,     \
         "rad/s", "speed of the reference")                                                        \
    FLAG(0x2302, reference_moving, reference.now.moving, "moving", TRACED,                         \
         "whether the reference moves")                                                            \
    FLAG(0x2303, holding, hold.active, "holding", TRACED, "d-axis hold in force")                  \
    NAMED(0x2304, synchronism, synchronism.shown, "synchronism", TRACED, drive_synchronism,        \
          "whether a sensorless drive's rotor runs with its estimate")                             \
    REAL(0x2320, i_d_A, current.d, "i_d_A", TRACED, current_A, "A",                                \
         "measured current along the rotor's flux")                                                \
    REAL(0x2321, i_q_A, current.q, "i_q_A", TRACED, current_A, "A",                                \
         "measured current that makes torque")                                                     \
    REAL(0x2322, i_d_ref_A, current_reference.d, "", TRACED, current_A, "A", "reference of i_d_A") \
    REAL(0x2323, i_q_ref_A, current_reference.q, "", TRACED, current_A, "A", "reference of i_q_A") \
    REAL(0x2324, u_d_V, voltage_command.d, "", TRACED, voltage_V, "V",                             \
         "commanded voltage, after the limit")                                                     \
    REAL(0x2325, u_q_V, voltage_command.q, "", TRACED, voltage_V, "V",                             \
         "commanded voltage, after the limit")                                                     \
    REAL(0x2326, resistance_est_ohm, estimator.estimate.winding.resistance, "resistance_ohm",      \
         TRACED, resistance_ohm, "ohm", "estimate of a phase's series resistance")                 \
    REAL(0x2327, bus_V, modulator.bus, "bus_V", UNTRACED, voltage_V, "V",                          \
         "measured supply; a trace has the true one under this name")                              \
    REAL(0x2328, phase_imbalance, enabling.phase_imbalance, "", UNTRACED, ratio, "",               \
         "by what share phase a's resistance, as measured, is above that of both, and b's below")  \
    REAL(0x2329, torque_constant_change, torque_constant.change, "", UNTRACED, ratio, "",          \
         "by what share the torque constant that motion shows is above that of the settings")      \
    REAL(0x232a, inductance_change, enabling.inductance_change, "", UNTRACED, ratio, "",           \
         "by what share the inductance found while enabling is above that of the settings")        \
    REAL(0x232b, current_offset_a_A, measurement.offset.current.a, "", UNTRACED, current_A, "A",   \
         "what enabling found the sensor of the current of phase a to read where there is none, "  \
         "and takes off")                                                                          \
    REAL(0x232c, current_offset_b_A, measurement.offset.current.b, "", UNTRACED, current_A, "A",   \
         "likewise, that of phase b")                                                              \
    REAL(0x232d, voltage_offset_a_V, measurement.offset.voltage.a, "", UNTRACED, voltage_V, "V",   \
         "what enabling found the sensor of the voltage of phase a to read where there is none, "  \
         "and takes off")                                                                          \
    REAL(0x232e, voltage_offset_b_V, measurement.offset.voltage.b, "", UNTRACED, voltage_V, "V",   \
         "likewise, that of phase b")                                                              \
    COUNT(0x2305, reference_underruns, planner.underruns, "underruns", UNTRACED,                   \
          "sines and set-points whose continuation came too late")                                 \
    COUNT(                                                                                         \
        0x2306, commands_dropped, commands.dropped, "dropped", UNTRACED,                           \
        "accepted, but in their period the drive could not obey them: it was in fault, as a "      \
        "rule, or a move would not have begun where the reference was; what a disable or a stop "  \
        "has flushed does not count")                                                              \
    NAMED(0x2307, dropped_kind, commands.dropped_kind, "", UNTRACED, drive_command_kind,           \
          "the last of them, if any")                                                              \
    NAMED(0x2308, position_reference, axis.reference, "position", UNTRACED,                        \
          drive_position_reference, "whether the axis has been homed, and is where it says")       \
    ANGLE(0x2315, motor_zero_rad, axis.origin, "", UNTRACED,                                       \
          "where the zero is that initial_angle_rad counts from; set-position moves it")           \
    REAL(0x2330, motor_heat, thermal.heat, "", UNTRACED, ratio, "",                                \
         "of the hotter phase's winding, 1 as the rated current makes it for ever; derating "      \
         "begins at 1.02")                                                                         \
    COUNT(0x2331, bridge_derating, thermal.bridge_derated, "", UNTRACED,                           \
          "of 64 steps of current_limit_A those that the bridge's temperature takes")

#endif
