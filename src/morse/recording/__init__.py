"""Recordings of runs in MCAP files: written while a simulation runs, read, and exported as tables."""
