"""The fair comparison of position laws: experiment, simulator, optimiser, table, plots, page."""
