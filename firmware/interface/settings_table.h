/*
 * The settings of a drive, declared once: a row each. From the rows follow the members of struct
 * motor_params and struct drive_settings, their defaults, ranges and refusals, the stored record,
 * the keys of a scenario's [drive] and the page settings.md. To add a setting: a row, and what
 * makes use of it.
 *
 *   CHOICE(index, member, type, constants, preset, when, sentence)   one of an enumeration
 *   FLAG(index, member, preset, when, sentence)
 *   REAL(index, member, unit, least, most, preset, when, sentence)
 *   REALS(index, member, count, unit, least, most, preset, when, sentence)   an array
 *   COUNT(index, member, unit, least, most, preset, when, sentence)  a whole number
 *
 * - index: of the object dictionary (CiA 301), manufacturer specific; it never changes and is never
 *   used again. An array takes as many as it has elements.
 * - least, most, preset: FIXED(value), or RATED(share) of the motor's rated current.
 * - preset FOLLOWS: NaN, "not given"; what it is then follows from motor, board and period when the
 *   drive starts (drive/default_settings.h, drive/board_limits.h). COMPUTED: from the motor at
 *   once.
 * - when it may change: AT_ENABLE, while the bridge is off, and acts at the next enable, for which
 *   the drive is designed anew; so do the motor's. IN_MOTION, in a drive that is ready, too, and
 *   acts at once there: drive/settings_in_motion.h says which constants of the interrupt it is.
 *
 * The order is that in which a scenario's keys are obeyed: feedback and law choose defaults of what
 * stands below them.
 */
#ifndef STEADYSTEP_SETTINGS_TABLE_H
#define STEADYSTEP_SETTINGS_TABLE_H

/* What the drive is set to of its motor; no preset: a motor file gives all of them. */
#define MOTOR_SETTINGS(REAL, COUNT)                                                                \
    REAL(0x2001, resistance_ohm, "ohm", FIXED(1e-3), FIXED(1e3), "R, of one phase")                \
    REAL(0x2002, inductance_H, "H", FIXED(1e-6), FIXED(1.0), "L, of one phase")                    \
    REAL(0x2003, torque_constant_Nm_A, "N m/A", FIXED(1e-4), FIXED(100.0),                         \
         "Km, and the back-EMF constant in V s/rad")                                               \
    REAL(0x2004, viscous_friction_Nms_rad, "N m s/rad", FIXED(0.0), FIXED(10.0), "Kv")             \
    REAL(0x2005, inertia_kgm2, "kg m2", FIXED(1e-9), FIXED(10.0), "J, of rotor and rigid load")    \
    REAL(0x2006, rated_current_A, "A", FIXED(1e-2), FIXED(50.0), "per phase, peak of the sine")    \
    REAL(0x2007, supply_V, "V", FIXED(5.0), FIXED(400.0), "nominal voltage of the bus")            \
    COUNT(0x2008, rotor_teeth, "", FIXED(1.0), FIXED(1000.0),                                      \
          "N, pole pairs: electrical turns per turn")

#define DRIVE_SETTINGS(CHOICE, FLAG, REAL, REALS, COUNT)                                           \
    CHOICE(0x2100, feedback, drive_feedback, DRIVE_FEEDBACKS, DRIVE_FEEDBACK_SENSORLESS,           \
           AT_ENABLE, "where the rotor's position comes from")                                     \
    CHOICE(0x2101, law, position_law, POSITION_LAW_COUNT, POSITION_LAW_STATE_FEEDBACK, AT_ENABLE,  \
           "position law; with an encoder feedback-linearisation")                                 \
    CHOICE(0x2102, estimator, drive_estimator, DRIVE_ESTIMATORS, DRIVE_ESTIMATOR_INVARIANT_EKF,    \
           AT_ENABLE, "of sensorless feedback")                                                    \
    CHOICE(0x2103, observer, drive_observer, DRIVE_OBSERVERS, DRIVE_OBSERVER_MODEL, AT_ENABLE,     \
           "on the encoder")                                                                       \
    CHOICE(0x2104, voltage_source, drive_voltage_source, DRIVE_VOLTAGE_SOURCES,                    \
           DRIVE_VOLTAGE_MEASURED, AT_ENABLE, "where the estimator's voltage comes from")          \
    CHOICE(0x2105, initial_position, drive_initial_position, DRIVE_INITIAL_POSITIONS,              \
           DRIVE_INITIAL_POSITION_ASSUMED, AT_ENABLE,                                              \
           "how a sensorless drive knows where its rotor stands")                                  \
    CHOICE(0x2106, synchronism_policy, drive_synchronism_policy, DRIVE_SYNCHRONISM_POLICIES,       \
           DRIVE_SYNCHRONISM_FAULT, IN_MOTION,                                                     \
           "what comes of a rotor that has lost step; sensorless")                                 \
    FLAG(0x2107, feed_forward, true, AT_ENABLE, "reference speed and acceleration into the law")   \
    FLAG(0x2108, detent_learning, false, AT_ENABLE,                                                \
         "learn and compensate the detent torque; with an encoder only, true for its default law") \
    FLAG(0x2109, bridge_loss_compensation, true, AT_ENABLE, "of dead time and diodes")             \
    FLAG(0x210a, resistance_adaptation, true, AT_ENABLE,                                           \
         "track the series resistance while holding")                                              \
    REAL(0x2110, law_bandwidth_rad_s, "rad/s", FIXED(1.0), FIXED(1e4), FOLLOWS, AT_ENABLE,         \
         "w0 of the position law, a pair of poles: 200, of the default law 300, with an encoder "  \
         "900, or what the period bears; sensorless at most Km / sqrt(J L)")                       \
    REAL(0x2111, current_bandwidth_rad_s, "rad/s", FIXED(10.0), FIXED(1e6), FOLLOWS, AT_ENABLE,    \
         "of the current loop inside it: 1500, with feedback-linearisation 2000, twice the swing " \
         "of a quicker hold, or what the period bears")                                            \
    REALS(0x2180, law_gains, DRIVE_LAW_GAINS, "", FIXED(-1e12), FIXED(1e12), FOLLOWS, AT_ENABLE,   \
          "the law's gains by its own names, instead of what the bandwidths make of them")         \
    REALS(0x21c0, detent_torque_Nm, DRIVE_DETENT_COEFFICIENTS, "N m", FIXED(-100.0), FIXED(100.0), \
          FIXED(0.0), AT_ENABLE,                                                                   \
          "a_1, b_1, a_2, b_2, a_4, b_4 of the electrical angle's harmonics: where learning "      \
          "begins if nothing is kept")                                                             \
    REAL(0x2120, current_limit_A, "A", RATED(0.01), RATED(2.0), RATED(1.0), IN_MOTION,             \
         "of the current reference")                                                               \
    REAL(0x2121, overcurrent_trip_A, "A", RATED(0.1), RATED(6.0), FOLLOWS, IN_MOTION,              \
         "a sampled phase current beyond it opens the bridge: 1.8 x rated current, cut to what "   \
         "the board measures")                                                                     \
    REAL(0x2122, speed_limit_rad_s, "rad/s", FIXED(0.1), FIXED(1e4), COMPUTED, AT_ENABLE,          \
         "an estimate beyond it opens the bridge: 1.3 x supply / Km, of a law without current "    \
         "control N w L / R = 4, cut to 0.24 electrical turn per period and 4 x supply / Km")      \
    REAL(0x2123, following_error_rad, "rad", FIXED(0.0), FIXED(100.0), FOLLOWS, AT_ENABLE,         \
         "with an encoder a rotor that is further from its reference, and not coming back, opens " \
         "the bridge: 1 electrical turn, with microstepping 0, which is not watched; cut to 14")   \
    REAL(0x2124, command_timeout_s, "s", FIXED(0.0), FIXED(3600.0), FIXED(0.0), AT_ENABLE,         \
         "a motion stops when no line or command has come for so long; 0: it goes on")             \
    REAL(0x2150, motor_time_constant_s, "s", FIXED(0.0), FIXED(1e4), FIXED(60.0), AT_ENABLE,       \
         "of the winding's heat: at that of the rated current the limit falls towards it, at "     \
         "1.15 of it the bridge opens; 0: not watched")                                            \
    REAL(0x2151, cold_resistance_ohm, "ohm", FIXED(0.0), FIXED(1e3), FIXED(0.0), AT_ENABLE,        \
         "resistance_ohm of `ready` with a cold motor: by what it has risen, by as much the "      \
         "winding is hot already; asks for resistance_adaptation; 0: not known")                   \
    REAL(0x2152, bridge_derate_C, "degC", FIXED(0.0), FIXED(150.0), FIXED(80.0), AT_ENABLE,        \
         "temperature of the bridge from which the current limit falls")                           \
    REAL(0x2153, bridge_fault_C, "degC", FIXED(0.0), FIXED(150.0), FIXED(100.0), AT_ENABLE,        \
         "to which it has fallen to nothing, and the bridge opens; 0: not watched")                \
    REAL(0x2158, brake_on_ratio, "", FIXED(1.05), FIXED(1.28), FIXED(1.25), AT_ENABLE,             \
         "of supply_V: from there on the brake resistor is on, if the board has one")              \
    REAL(0x2159, brake_hysteresis, "", FIXED(0.005), FIXED(0.03), FIXED(0.03), AT_ENABLE,          \
         "of supply_V: so far below brake_on_ratio it is off")                                     \
    REAL(0x215a, brake_duty, "", FIXED(1e-3), FIXED(1.0), FIXED(0.1), AT_ENABLE,                   \
         "share of time for which the brake resistor may be on for good")                          \
    REAL(0x215b, brake_pulse_s, "s", FIXED(1e-3), FIXED(30.0), FIXED(1.0), AT_ENABLE,              \
         "for which it may be on from cold; beyond it rests until half of the heat is gone")       \
    COUNT(                                                                                         \
        0x2160, inputs_used, "", FIXED(0.0), FIXED(31.0), FIXED(0.0), AT_ENABLE,                   \
        "inputs that are wired, added up: 1 limit -, 2 limit +, 4 home, 8 enable, 16 quick stop; " \
        "acts at once")                                                                            \
    COUNT(0x2161, inputs_low, "", FIXED(0.0), FIXED(31.0), FIXED(0.0), AT_ENABLE,                  \
          "of them those that are active while low; an open input is high; acts at once")          \
    COUNT(                                                                                         \
        0x2162, outputs_low, "", FIXED(0.0), FIXED(7.0), FIXED(0.0), AT_ENABLE,                    \
        "outputs that are low while active, added up: 1 alarm, 2 in position, 4 brake released; "  \
        "acts at once")                                                                            \
    COUNT(0x2112, rotor_inertia_percent, "%", FIXED(5.0), FIXED(100.0), FIXED(100.0), AT_ENABLE,   \
          "of inertia_kgm2 what turns before a belt or a coupling that gives: the default "        \
          "law_bandwidth_rad_s is less by it")                                                     \
    REAL(                                                                                          \
        0x2163, holding_brake_s, "s", FIXED(0.0), FIXED(2.0), FIXED(0.0), AT_ENABLE,               \
        "so long before `disable` takes the current the holding brake engages; 0: none is fitted") \
    REAL(0x2130, observer_bandwidth_rad_s, "rad/s", FIXED(1.0), FIXED(1e6), FOLLOWS, AT_ENABLE,    \
         "triple pole of the model observer: 1000, of the default law with an encoder 1400, of a " \
         "light rotor what its swings ask for, or what period and counts bear")                    \
    REAL(0x2131, high_gain_epsilon_s, "s", FIXED(1e-7), FIXED(1.0), FIXED(1e-3), AT_ENABLE,        \
         "of the high-gain observer")                                                              \
    COUNT(0x2009, encoder_counts_per_turn, "", FIXED(0.0), FIXED(1073741824.0), FIXED(0.0),        \
          AT_ENABLE, "quadrature counts; 0: as the board has it")                                  \
    COUNT(0x2125, node_id, "", FIXED(1.0), FIXED(127.0), FIXED(1.0), AT_ENABLE,                    \
          "the drive's number on a fieldbus; acts when the channel is opened")                     \
    REAL(0x2132, encoder_zero_rad, "rad", FIXED(-1e4), FIXED(1e4), FIXED(0.0), AT_ENABLE,          \
         "rotor angle where count 0 begins")                                                       \
    REAL(0x2133, initial_load_torque_Nm, "N m", FIXED(-100.0), FIXED(100.0), FIXED(0.0),           \
         AT_ENABLE, "load that the model observer begins with")                                    \
    FLAG(0x2134, encoder_zero_known, false, AT_ENABLE,                                             \
         "absolute encoder or indexed: the rotor's angle follows from the count, else it is "      \
         "initial_angle_rad at the end of the hold")                                               \
    FLAG(0x2126, modbus_rtu, false, AT_ENABLE, "the serial line carries Modbus RTU from power-up") \
    REAL(0x2135, initial_torque_constant_change, "", FIXED(-0.2), FIXED(0.2), FIXED(0.0),          \
         AT_ENABLE, "where torque_constant_change begins: store keeps here what was learned")      \
    FLAG(0x2140, calibrate_offsets, true, AT_ENABLE,                                               \
         "step of enabling, with the bridge off, then on")                                         \
    FLAG(0x2141, hold_on_enable, true, AT_ENABLE,                                                  \
         "step of enabling: hold_on_enable_s before ready; an encoder's zero is found first")      \
    FLAG(0x214c, balance_phases, true, AT_ENABLE,                                                  \
         "step of enabling without an encoder, behind the hold: the ratio of the phases, half a "  \
         "full step away and back")                                                                \
    FLAG(0x214f, identify_inductance, FINDS_INDUCTANCE, AT_ENABLE,                                 \
         "with balance_phases: the motor's inductance, of swings of the hold current")             \
    FLAG(0x2142, hold_at_rest, true, AT_ENABLE, "d-axis current at rest; with an encoder false")   \
    FLAG(                                                                                          \
        0x2143, standstill_pulses, false, AT_ENABLE,                                               \
        "pulses on the hold current show the rotor's angle under load, of a motor that saturates") \
    REAL(0x2144, hold_on_enable_s, "s", FIXED(0.01), FIXED(10.0), FIXED(0.150), AT_ENABLE,         \
         "half of it behind the search for an encoder's zero")                                     \
    REAL(0x2145, hold_current_A, "A", RATED(0.01), RATED(1.0), FOLLOWS, AT_ENABLE,                 \
         "d-axis current at rest: rated (pulses: half), or what of it the hold's check passes; "   \
         "bears Km x it, heats the winding by R x its square")                                     \
    REAL(0x214d, idle_current_A, "A", RATED(0.01), RATED(1.0), FOLLOWS, AT_ENABLE,                 \
         "hold current after idle_delay_s at rest, bears and heats likewise: hold_current_A")      \
    REAL(0x214e, idle_delay_s, "s", FIXED(0.0), FIXED(3600.0), FIXED(1.0), AT_ENABLE,              \
         "at rest before the hold current falls to idle_current_A")                                \
    REAL(                                                                                          \
        0x2146, motion_current_A, "A", FIXED(0.0), RATED(1.0), FOLLOWS, IN_MOTION,                 \
        "d-axis current in motion, none of it from a quarter of V / Km on: 0, or sensorless with " \
        "little flux 0.375 of the rated")                                                          \
    REAL(0x2147, hold_ramp_s, "s", FIXED(1e-3), FIXED(1.0), FIXED(0.010), AT_ENABLE,               \
         "time for the hold current to ramp in; out, 1.25 of it without an encoder")               \
    REAL(0x2148, hold_delay_s, "s", FIXED(0.0), FIXED(100.0), FOLLOWS, AT_ENABLE,                  \
         "from the end of a profile to the hold: 0.015, of a hold quicker than 280 rad/s 4.2 "     \
         "over that")                                                                              \
    REAL(0x2149, hold_bandwidth_rad_s, "rad/s", FIXED(1.0), FIXED(1e4), FOLLOWS, AT_ENABLE,        \
         "w0 of the state feedback whose damping the hold takes: 200, a quarter of its swing, or " \
         "what the current loop bears")                                                            \
    REAL(0x214a, initial_angle_rad, "rad", FIXED(-1e4), FIXED(1e4), FIXED(0.0), AT_ENABLE,         \
         "mechanical rotor angle that the drive assumes")                                          \
    REAL(0x214b, initial_angle_error_rad, "rad", FIXED(-10.0), FIXED(10.0), FIXED(0.0), AT_ENABLE, \
         "added to it, so that the drive assumes something wrong; for simulation")

/* The settings that are one of several: constant, text, sentence. */
#define DRIVE_FEEDBACK_CHOICES(X)                                                                  \
    X(DRIVE_FEEDBACK_SENSORLESS, "sensorless", "the estimator, from currents and voltages")        \
    X(DRIVE_FEEDBACK_ENCODER, "encoder", "an observer on the encoder's counts")

#define DRIVE_ESTIMATOR_CHOICES(X)                                                                 \
    X(DRIVE_ESTIMATOR_INVARIANT_EKF, "invariant-ekf",                                              \
      "constant-gain invariant EKF, exact current prediction")                                     \
    X(DRIVE_ESTIMATOR_STEADY_STATE_EKF, "steady-state-ekf",                                        \
      "Bendjedia 2012: constant gain, Euler predictor")

#define DRIVE_OBSERVER_CHOICES(X)                                                                  \
    X(DRIVE_OBSERVER_MODEL, "model", "of the motor's mechanics, from counts and currents")         \
    X(DRIVE_OBSERVER_HIGH_GAIN, "high-gain",                                                       \
      "Seshagiri and Khalil: from counts alone; for simulation")

#define DRIVE_VOLTAGE_SOURCE_CHOICES(X)                                                            \
    X(DRIVE_VOLTAGE_MEASURED, "measured", "the board's leg voltages, averaged over a period")      \
    X(DRIVE_VOLTAGE_COMMANDED, "commanded",                                                        \
      "what was commanded, less what the bridge is known to take of it: for boards without "       \
      "leg-voltage dividers")

#define DRIVE_INITIAL_POSITION_CHOICES(X)                                                          \
    X(DRIVE_INITIAL_POSITION_ASSUMED, "assumed",                                                   \
      "initial_angle_rad, into which the hold draws it")                                           \
    X(DRIVE_INITIAL_POSITION_IMPULSES, "impulses",                                                 \
      "found by voltage impulses within the electrical turn nearest to initial_angle_rad; by "     \
      "alignment if the motor does not show it")                                                   \
    X(DRIVE_INITIAL_POSITION_PUBLISHED_IMPULSES, "published-impulses",                             \
      "the same in Bendjedia's order; for comparison")

#define DRIVE_SYNCHRONISM_POLICY_CHOICES(X)                                                        \
    X(DRIVE_SYNCHRONISM_FAULT, "fault", "opens the bridge")                                        \
    X(DRIVE_SYNCHRONISM_WARN, "warn", "says so and goes on")                                       \
    X(DRIVE_SYNCHRONISM_OFF, "off", "is not watched")

#endif
