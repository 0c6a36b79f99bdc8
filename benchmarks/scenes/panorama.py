"""A laser scanner of 16 rows all around, as a user would write it."""

from benchmarks import work
from morse.core.sensor import Sensor
from morse.helpers.components import add_data


class Panorama(Sensor):
    """Measures ranges all around."""

    _name = "Panorama"
    _short_desc = "Ranges of 16 rows all around"

    add_data("ranges", [], "list<float>", "Ranges, row by row", unit="m")

    def __init__(self, obj, parent=None):
        super().__init__(obj, parent)
        self._rays = self.context.world.rays.bundle(obj, work.panorama_rays(), work.PANORAMA_RANGE)

    def default_action(self):
        """Look around."""
        self._rays.refresh()
        self.local_data["ranges"] = self._rays.ranges
