"""The @name@ sensor: what it measures."""

import logging

from morse.core.sensor import Sensor
from morse.core.services import service
from morse.helpers.components import add_data

logger = logging.getLogger("morse." + __name__)

COLORS = ('blue', 'red', 'green', 'yellow')


class @classname@(Sensor):
    """@shortdesc@"""

    _name = "@classname@"
    _short_desc = "@shortdesc@"

    # What the sensor publishes: name, initial value, type, description.
    add_data('distance', 0.0, 'float', 'Distance from the origin along the X axis', unit='m')
    add_data('color', 'none', 'string', 'A random colour')

    def __init__(self, obj, parent=None):
        """obj is the sensor itself in the simulation, parent the robot that carries it."""
        logger.info("%s initialization", obj.name)
        super().__init__(obj, parent)

        # A random generator: the same `morse run --seed` gives the same colours.
        self._random = self.context.random(self.name())

        logger.info("Component initialized")

    @service
    def get_current_distance(self):
        """A service: clients call it by its name, and receive the value that it returns."""
        return self.local_data['distance']

    def default_action(self):
        """One measurement; called at the frequency of the sensor."""
        # position_3d is the pose of the sensor in the world: x, y, z, yaw, pitch, roll
        self.local_data['distance'] = self.position_3d.x
        self.local_data['color'] = COLORS[self._random.integers(len(COLORS))]
