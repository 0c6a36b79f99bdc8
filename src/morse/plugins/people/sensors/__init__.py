"""Sensors of people."""
