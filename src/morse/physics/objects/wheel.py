"""The handle of a wheeled robot for one of its wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.physics.model.shapes import wheel_axis, wheel_size
from morse.physics.poses import rigid
from morse.physics.poses.convert import ANGULAR_VELOCITY

if TYPE_CHECKING:
    import mujoco

    from morse.core.world import Body
    from morse.physics.model.layout import Slot
    from morse.physics.objects.object_world import Posed
    from morse.physics.state.engine_state import EngineState


class Wheel:
    """A driven wheel.

    Attributes:
        object: the wheel in the world.
        radius: radius, m.
        offset_y: distance to the left of the centre of the robot, m.
        offset_x: distance in front of the centre of the robot, m.
    """

    #: created from the scene, without a state; cached values of the engine are not saved
    is_apparatus = True

    def __init__(self, state: EngineState, wheel: Body, robot: Posed) -> None:
        self._state = state
        self.object = wheel
        self._model: mujoco.MjModel | None = None
        self._actuator = -1
        self._controls = state.data.ctrl
        self.radius = wheel_size(wheel.node, wheel_axis(wheel.node, robot.node))[0]
        self.offset_x, self.offset_y, _ = rigid.relative(*robot.world_pose(), *wheel.world_pose())[0]

    @property
    def _slot(self) -> Slot:
        return self._state.slots[self._state.slot_of[self.object.node]]

    def set_speed(self, speed: float) -> None:
        """Set the speed of the motor, rad/s; positive drives forward. Larger values are limited to the maximum speed.

        Raises:
            ValueError: the value is not a number.
        """
        limit = ANGULAR_VELOCITY.limit
        if not -limit <= speed <= limit:
            if speed != speed:
                raise ValueError(f"the speed of a wheel is a number, not {speed!r}")
            speed = min(max(speed, -limit), limit)
        state = self._state
        if self._model is not state.model:
            # objects were added or removed, so the engine has a new model
            self._model, self._actuator, self._controls = state.model, self._slot.actuator, state.data.ctrl
        self._controls[self._actuator] = speed

    @property
    def angle(self) -> float:
        """Angle since the start, rad."""
        return float(self._state.data.qpos[self._slot.qpos])

    @property
    def speed(self) -> float:
        """Angular speed, rad/s."""
        return float(self._state.data.qvel[self._slot.dof])
