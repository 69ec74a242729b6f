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
]
