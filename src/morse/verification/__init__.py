"""Runs a scene again, in other circumstances, and compares every tick."""
