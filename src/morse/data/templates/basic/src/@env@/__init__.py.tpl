"""What @env@ adds to MORSE: how its robots, sensors and actuators behave."""
