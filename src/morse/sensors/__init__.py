"""Sensors: one class a file."""
