"""Recordings of runs in MCAP files: written while a simulation runs, read again, turned into tables."""
