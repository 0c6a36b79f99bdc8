"""A sensor that measures nothing: the minimum cost of a component."""

from morse.core.sensor import Sensor


class Idle(Sensor):
    """Does nothing."""

    _name = "Idle"
    _short_desc = "Measures nothing"

    def default_action(self):
        """Nothing."""
