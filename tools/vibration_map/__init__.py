"""What a load that oscillates may have, frequency by frequency: what tools/vibration is made of."""
