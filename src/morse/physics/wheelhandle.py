"""The handle that a wheeled robot holds of one of its wheels."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.physics import rigid
from morse.physics.layout import Motion
from morse.physics.wheels import wheel_axis, wheel_size

if TYPE_CHECKING:
    from morse.physics.gameobject import GameObject
    from morse.physics.world import World


class Wheel:
    """A driven wheel.

    Attributes:
        object: the wheel in the world.
        radius: metres.
        offset_y: metres to the left of the robot's centre.
        offset_x: metres ahead of it.
    """

    def __init__(self, world: World, index: int, robot: GameObject) -> None:
        self._world = world
        self._slot = world.slots[index]
        node = self._slot.frame.node
        self.object = world.object_of(node)
        self.radius = wheel_size(node, wheel_axis(node, robot.node))[0]
        self.offset_x, self.offset_y, _ = rigid.relative(*robot.world_pose(), *self.object.world_pose())[0]

    def set_speed(self, speed: float) -> None:
        """Turn at ``speed`` rad/s; positive drives forward."""
        self._world.data.ctrl[self._slot.actuator] = speed

    @property
    def angle(self) -> float:
        """Angle turned since the start, rad."""
        return float(self._world.data.qpos[self._slot.qpos])

    @property
    def speed(self) -> float:
        """Angular speed, rad/s."""
        return float(self._world.data.qvel[self._slot.dof])


def wheels_of(world: World, robot: GameObject) -> list[Wheel]:
    """The driven wheels of a robot, in the order of the scene."""
    return [
        Wheel(world, index, robot)
        for index, slot in enumerate(world.slots)
        if slot.frame.motion is Motion.HINGE and slot.frame.parent is world.slots[robot.slot].frame
    ]
