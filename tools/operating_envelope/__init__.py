"""Where the sensorless drive keeps its lock: points, outcomes, journal, picture."""
