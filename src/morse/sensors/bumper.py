"""A bumper switch."""

from morse.core.declarations import BuilderDefaults, Visual
from morse.helpers.components import add_kind, add_property, add_state
from morse.sensors.collision import ContactSensor, touched_names


class Bumper(ContactSensor):
    """Reports at each measurement whether objects press it, and which.

    Its body is a bar of 4 cm x 40 cm x 10 cm, unless the script scales it. Mount the bumper at the edge of the robot:
    objects closer to the bar than ``Travel`` press it. See `Collision` for a sensor that publishes only while it
    touches an object.
    """

    _name = "Bumper"
    _short_desc = "A bumper that reports whether an object presses it"
    _builder = BuilderDefaults(visual=Visual("cube", (0.02, 0.2, 0.05), (0.1, 0.1, 0.1)))

    add_property(
        "_travel", 0.005, "Travel", "float", "Distance at which an object presses it", unit="m", low=0.0, high=1.0
    )
    add_kind("contact", touching="collision", names=touched_names)

    add_state("margin", float, "Distance below which objects touch", unit="m")

    _travel: float

    def measure(self) -> None:
        """Measure which objects press the bumper."""
        self.margin = self._travel
        self.take(self.touched())
