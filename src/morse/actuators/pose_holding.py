"""The base class of actuators that set the pose of a robot every tick."""

from morse.core.actuator import Actuator


class PoseHolding(Actuator):
    """Holds the robot at a pose, independent of forces; the robot is released when the actuator is deactivated."""

    @property
    def active(self) -> bool:
        """Whether it holds the robot."""
        return self._active

    @active.setter
    def active(self, value: bool) -> None:
        Actuator.active.fset(self, value)  # type: ignore[attr-defined] # a property
        if not self._active:
            self.robot_parent.bge_object.restoreDynamics()
