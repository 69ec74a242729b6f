"""Mutants that change nothing a test could see, each with its reason.

A row is the file, the lines that the mutant touches as they are and as they become (white space does
not matter), and why no answer of the drive differs.
"""
EQUIVALENT = [
]
