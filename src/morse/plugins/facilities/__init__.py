"""Doors, lifts, conveyors and signals."""
