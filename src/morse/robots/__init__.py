"""Robots, one class per file."""
