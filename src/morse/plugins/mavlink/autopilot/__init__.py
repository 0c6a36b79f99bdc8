"""A small autopilot: modes, commands, missions and parameters of MAVLink, for robots that MORSE controls itself."""
