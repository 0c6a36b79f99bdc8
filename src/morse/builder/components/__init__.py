"""The public builder classes: robots, sensors, actuators and other objects."""
