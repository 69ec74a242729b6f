/*
 * The registry of position laws: LAW(name of the constant, of files and functions, in scenarios).
 * Knows no number format. To add a law: position_law.h.
 */
#ifndef STEADYSTEP_POSITION_LAWS_H
#define STEADYSTEP_POSITION_LAWS_H

#define CURRENT_LAWS(LAW)                                                                          \
    LAW(STATE_FEEDBACK, state_feedback, "state-feedback")                                          \
    LAW(PID, pid, "pid")

#define VOLTAGE_LAWS(LAW)                                                                          \
    LAW(FEEDBACK_LINEARISATION, feedback_linearisation, "feedback-linearisation")                  \
    LAW(MICROSTEPPING, microstepping, "microstepping")                                             \
    LAW(STMMS, stmms, "stmms")                                                                     \
    LAW(STMMS_PLUS, stmms_plus, "stmms-plus")                                                      \
    LAW(FOC, foc, "foc")                                                                           \
    LAW(CSMC, csmc, "csmc")                                                                        \
    LAW(CSMC_EQUIVALENT, csmc_equivalent, "csmc-equivalent")                                       \
    LAW(CSMC_SERVO, csmc_servo, "csmc-servo")                                                      \
    LAW(SMC, smc, "smc")

#define POSITION_LAWS(LAW)                                                                         \
    CURRENT_LAWS(LAW)                                                                              \
    VOLTAGE_LAWS(LAW)

#define POSITION_LAW_ENUMERATE(constant, function, text) POSITION_LAW_##constant,
enum position_law { POSITION_LAWS(POSITION_LAW_ENUMERATE) POSITION_LAW_COUNT };
#undef POSITION_LAW_ENUMERATE

/* Behind the last current law. */
#define CURRENT_LAW_ENUMERATE(constant, function, text) CURRENT_LAW_##constant,
enum current_law { CURRENT_LAWS(CURRENT_LAW_ENUMERATE) POSITION_LAW_VOLTAGE_FIRST };
#undef CURRENT_LAW_ENUMERATE

#endif
