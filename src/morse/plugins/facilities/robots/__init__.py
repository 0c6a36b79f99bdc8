"""Doors and lifts in a run."""
