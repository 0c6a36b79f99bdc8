"""What scene scripts import: the robots, sensors and actuators of @env@ with their equipment."""
