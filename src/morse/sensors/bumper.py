"""A switch that is pressed by what the robot runs into."""

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_kind, add_property
from morse.sensors.collision import ContactSensor, touched_names


class Bumper(ContactSensor):
    """Tells at each measurement whether something presses it, and what.

    Its body is a bar, 4 cm x 40 cm x 10 cm unless the script scales it. Mount it at the edge of the robot: what comes
    nearer to the bar than ``Travel`` presses it. See `Collision` for a sensor that publishes only while it touches
    something.
    """

    _name = "Bumper"
    _short_desc = "A bumper that tells whether something presses it"
    _builder = BuilderDefaults(visual=Visual("cube", (0.02, 0.2, 0.05), (0.1, 0.1, 0.1)))

    add_property("_travel", 0.005, "Travel", "float", "How near something has to be", unit="m", low=0.0, high=1.0)
    add_kind("contact", touching="collision", names=touched_names)

    _travel: float

    def measure(self) -> None:
        """Take what presses it."""
        self.margin = self._travel
        self.take(self.touched())
