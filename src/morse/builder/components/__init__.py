"""What users call: robots, sensors, actuators and things, and their methods."""
