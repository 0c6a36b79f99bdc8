"""The behaviour of components: what every robot, sensor and actuator has in common."""
