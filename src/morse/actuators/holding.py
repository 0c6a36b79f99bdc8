"""What actuators that put a robot somewhere every tick have in common."""

from morse.core.actuator import Actuator


class Holding(Actuator):
    """Keeps the robot where it puts it, whatever acts on it; switched off, it lets the robot go."""

    @property
    def active(self) -> bool:
        """Whether it holds the robot."""
        return self._active

    @active.setter
    def active(self, value: bool) -> None:
        self._active = bool(value)
        if not self._active:
            self.robot_parent.bge_object.restoreDynamics()
