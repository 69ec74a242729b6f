"""What the ARM image of the firmware is made of and what it costs to run it."""
