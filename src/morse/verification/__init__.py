"""Repeats a scene under different conditions, and compares every tick."""
