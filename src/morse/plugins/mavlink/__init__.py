"""Autopilots and ground stations: MAVLink 2."""
