"""Actuators, one class per file."""
