"""The table of faults: what breaks, in which operation of which drive, and what the drive says of it."""
