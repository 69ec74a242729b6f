"""How tools spread the runs of the simulator: on this machine's cores, or over a cluster."""
