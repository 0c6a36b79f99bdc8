"""Converts the objects of a script into the scene for the simulation."""
