"""The @name@ robot: how it behaves."""

import logging

from morse.core.robot import Robot

logger = logging.getLogger("morse." + __name__)


class @classname@(Robot):
    """What the @name@ does while the simulation runs.

    Its equipment is in @env@/builder/robots/@name@.py
    """

    _name = '@name@ robot'

    def __init__(self, obj, parent=None):
        """obj is the body of the robot in the simulation; a robot has no parent."""
        logger.info("%s initialization", obj.name)
        super().__init__(obj, parent)

        # Prepare here what the robot needs.

        logger.info("Component initialized")

    def default_action(self):
        """Called at every step of the simulation: 60 times per simulated second."""
        # Most robots do nothing here: their sensors and actuators do the work.
