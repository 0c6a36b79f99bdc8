"""The @name@ actuator: what it does."""

import logging

from morse.core import status
from morse.core.actuator import Actuator
from morse.core.services import async_service, interruptible, service
from morse.helpers.components import add_data

logger = logging.getLogger("morse." + __name__)


class @classname@(Actuator):
    """@shortdesc@"""

    _name = "@classname@"
    _short_desc = "@shortdesc@"

    # What clients can send: name, initial value, type, description.
    add_data('counter', 0, 'int', 'Increases by one at each step of the simulation')

    def __init__(self, obj, parent=None):
        """obj is the actuator itself in the simulation, parent the robot that carries it."""
        logger.info("%s initialization", obj.name)
        super().__init__(obj, parent)

        # the value that the service async_test waits for, or None
        self._target = None

        logger.info("Component initialized")

    @service
    def get_counter(self):
        """A service: clients call it by its name, and receive the value that it returns."""
        return self.local_data['counter']

    @interruptible
    @async_service
    def async_test(self, value: int):
        """An asynchronous service: it ends when the counter exceeds the value.

        The method returns immediately; `self.completed(...)` sends the result to the client later.
        """
        # because of `value: int`, a call with another value is refused with a message
        self._target = value

    def interrupt(self):
        """Called when the client cancels async_test or calls it again: stop the running service."""
        self._target = None
        super().interrupt()

    def default_action(self):
        """One step; called at the frequency of the actuator."""
        # local_data contains the last values from clients, or the initial values.
        # self.robot_parent.bge_object is the body of the robot, which an actuator moves.
        self.local_data['counter'] += 1

        if self._target is not None and self.local_data['counter'] > self._target:
            self._target = None
            self.completed(status.SUCCESS, self.local_data['counter'])
