"""Mutants that change nothing a test could see, each with its reason.

A row is the file, the lines that the mutant touches as they are and as they become (white space does
not matter), and why no answer of the drive differs.
"""
EQUIVALENT = [
    ("firmware/design/hold_check.c",
     "const bool offset = gains->bias_return_V_Nm != 0.0 || gains->k_bias_q_V_A != 0.0;",
     "const bool offset = gains->bias_return_V_Nm != 1.0 || gains->k_bias_q_V_A != 0.0;",
     "adds an offset that nothing corrects: a mode at rest, which the damping leaves out as drift, "
     "and that begins and stays at zero in the answer to a load"),
    ("firmware/drive/encoder_aligning.c",
     "const double allowed = rated < settings->current_limit_A ? rated : "
     "settings->current_limit_A;",
     "const double allowed = rated <= settings->current_limit_A ? rated : "
     "settings->current_limit_A;",
     "the lesser of two that are equal"),
    ("firmware/design/refusal.c",
     ".limit = value > high ? high : low,", ".limit = value >= high ? high : low,",
     "a value on a bound is not refused"),
    ("firmware/design/refusal.c",
     '.relation = value > high ? "at most" : "at least",',
     '.relation = value >= high ? "at most" : "at least",',
     "a value on a bound is not refused"),
    ("firmware/design/servocompensator_design.c",
     "return 0.5 * y * alternating_series(y, 3, 4);",
     "return 0.5 * y * alternating_series(y, 3, 5);",
     "a term more of a series that is cut below 1e-14"),
    ("firmware/motion/profile.c", "uint32_t ramp = 0;", "uint32_t ramp = 1;",
     "is written before it is read: whole_periods() fails or writes"),
    ("firmware/motion/profile.c", "uint32_t duration = 0;", "uint32_t duration = 1;",
     "is written before it is read: whole_periods() fails or writes"),
    ("firmware/design/servocompensator_design.c",
     "return x * alternating_series(x * x, 2, 4);",
     "return x * alternating_series(x * x, 2, 8);",
     "terms more of a series that is cut below 1e-14"),
    ("firmware/drive/parameter_store.c", "if (!(steps > -2147483647.0)) {",
     "if (!(steps >= -2147483647.0)) {", "the bound itself becomes what is beyond it"),
]
