"""Doors and lifts."""
