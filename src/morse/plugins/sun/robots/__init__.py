"""Lamps in a run."""
