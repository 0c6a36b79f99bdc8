"""Sensors, one class per file."""
