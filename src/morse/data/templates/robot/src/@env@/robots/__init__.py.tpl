"""How the robots of @env@ behave."""
