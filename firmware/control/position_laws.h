/*
 * The registry of position laws: LAW(name of the constant, of files and functions, in scenarios).
 * Knows no number format.
 */
#ifndef STEADYSTEP_POSITION_LAWS_H
#define STEADYSTEP_POSITION_LAWS_H

#define POSITION_LAWS(LAW)                                                                         \
    LAW(STATE_FEEDBACK, state_feedback, "state-feedback")                                          \
    LAW(PID, pid, "pid")

#define POSITION_LAW_ENUMERATE(constant, function, text) POSITION_LAW_##constant,
enum position_law { POSITION_LAWS(POSITION_LAW_ENUMERATE) POSITION_LAW_COUNT };
#undef POSITION_LAW_ENUMERATE

#endif
