"""Actuators: one class a file."""
