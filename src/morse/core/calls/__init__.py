"""Calls of services that take time: their progress, and their answers."""
