"""How the actuators of @env@ behave."""
