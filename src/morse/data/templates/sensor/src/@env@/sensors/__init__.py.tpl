"""How the sensors of @env@ behave."""
