"""A sensor that measures nothing: what every component costs."""

from morse.core.sensor import Sensor


class Idle(Sensor):
    """Does nothing."""

    _name = "Idle"
    _short_desc = "Measures nothing"

    def default_action(self):
        """Nothing."""
