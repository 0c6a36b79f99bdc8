"""A pan-tilt unit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.core import status
from morse.core.actuator import Actuator
from morse.core.calls import of_joints
from morse.core.classes.builder_defaults import BuilderDefaults
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.limits import ANGLE, Angle, Position
from morse.core.reports.quoting import nearest
from morse.core.robot_parts import MovingPart
from morse.core.services import async_service, interruptible, service
from morse.helpers.components import add_data, add_kind, add_property

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.robot import Robot
    from morse.core.world import Body

_BASE, _HEAD = "PanBase", "TiltBase"


class PTU(Actuator):
    """Pans about its Z axis and tilts about its Y axis at constant speed, with all objects appended to it.

    A positive pan is a rotation to the left, a positive tilt is downward. To look at a point, its X axis is aimed at
    the point as seen from the base of the unit: on a level robot pan = atan2(dy, dx) - yaw and tilt = -asin(dz / d).
    """

    _name = "Pan-Tilt Unit"
    _short_desc = "Motion controller which pans and tilts the objects attached to it"
    _builder = BuilderDefaults(model="ptu", properties={"Tolerance": 0.01})

    add_data("pan", 0.0, "float", "About the Z axis, positive to the left", frame="joint", **ANGLE)
    add_data("tilt", 0.0, "float", "About the Y axis, positive downward", frame="joint", **ANGLE)
    add_kind("joints", names=("pan", "tilt"), position=("pan", "tilt"))
    add_property("_speed", 1.0, "Speed", "float", "Angular speed of each joint", unit="rad/s", low=0.0, high=1e4)
    add_property(
        "_tolerance",
        math.radians(0.3),
        "Tolerance",
        "float",
        "A service ends when both joints are this close to their setpoints",
        unit="rad",
        low=0.0,
    )
    add_property("_manual", False, "Manual", "bool", "The joints are controlled by something else")

    _speed: float
    _tolerance: float
    _manual: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._base, self._head = _part(obj, _BASE), _part(obj, _HEAD)

    # -- joints ----------------------------------------------------------------------------

    @property
    def pan(self) -> float:
        """Angle of the pan joint, rad, -pi to pi."""
        r = self._base.local_pose()[1]
        return math.atan2(r[3], r[0])

    @property
    def tilt(self) -> float:
        """Angle of the tilt joint, rad, -pi to pi."""
        r = self._head.local_pose()[1]
        return math.atan2(r[2], r[0])

    def moving_parts(self) -> list[MovingPart]:
        """The base, which pans, and the head, which tilts."""
        return [
            MovingPart("pan", self._base, None, (0.0, 0.0, 1.0), lambda: self.pan),
            MovingPart("tilt", self._head, self._base, (0.0, 1.0, 0.0), lambda: self.tilt),
        ]

    def default_action(self) -> None:
        """Rotate the joints by one tick."""
        pan, tilt = self.pan, self.tilt
        to_pan = math.remainder(self.local_data["pan"] - pan, math.tau)
        to_tilt = math.remainder(self.local_data["tilt"] - tilt, math.tau)
        if not self._manual:
            step = self._speed / self.frequency
            if to_pan:
                pan_step = min(max(to_pan, -step), step)
                c, s = math.cos(pan + pan_step), math.sin(pan + pan_step)
                self._base.set_local_pose(self._base.local_pose()[0], (c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0))
                to_pan = _rest(to_pan, pan_step)
            if to_tilt:
                pan_step = min(max(to_tilt, -step), step)
                c, s = math.cos(tilt + pan_step), math.sin(tilt + pan_step)
                self._head.set_local_pose(self._head.local_pose()[0], (c, 0.0, s, 0.0, 1.0, 0.0, -s, 0.0, c))
                to_tilt = _rest(to_tilt, pan_step)
        if self.on_completion is not None and max(abs(to_pan), abs(to_tilt)) <= self._tolerance:
            self.completed(status.SUCCESS)

    def interrupt(self) -> None:
        """Stop at the present angles."""
        self.local_data["pan"], self.local_data["tilt"] = self.pan, self.tilt
        super().interrupt()

    def progress(self) -> dict[str, object]:
        """Return both angles and their setpoints."""
        return of_joints(("pan", "tilt"), (self.pan, self.tilt), (self.local_data["pan"], self.local_data["tilt"]))

    # -- services --------------------------------------------------------------------------

    @interruptible
    @async_service
    def set_pan_tilt(self, pan: Angle, tilt: Angle) -> None:
        """Rotate both joints; the service ends when they have arrived.

        Args:
            pan: radians, to the left.
            tilt: radians, downward.
        """
        self.local_data["pan"], self.local_data["tilt"] = float(pan), float(tilt)

    @service(changes=False)
    def get_pan_tilt(self) -> list[float]:
        """Return the present angles of both joints, rad."""
        return [self.pan, self.tilt]

    @interruptible
    @async_service
    def look_at_point(self, x: Position, y: Position, z: Position) -> None:
        """Look at a point in the world; the service ends when the joints have arrived.

        Args:
            x: metres.
            y: metres.
            z: metres.
        """
        self._aim((x, y, z))

    @interruptible
    @async_service
    def look_at_object(self, obj_name: str) -> None:
        """Look at the present position of an object; the service ends when the joints have arrived.

        Args:
            obj_name: name of the object in the scene.
        """
        objects = self.context.world.objects_by_name
        if obj_name not in objects:
            raise MorseRPCInvokationError(f"there is no object '{obj_name}'{nearest(obj_name, sorted(objects))}")
        self._aim(objects[obj_name].world_pose()[0])

    def _aim(self, place: Sequence[float]) -> None:
        (x, y, z), r = self.bge_object.world_pose()
        dx, dy, dz = place[0] - x, place[1] - y, place[2] - z
        ahead, left, up = (r[i] * dx + r[i + 3] * dy + r[i + 6] * dz for i in (0, 1, 2))
        if ahead or left or up:
            self.local_data["pan"] = math.atan2(left, ahead)
            self.local_data["tilt"] = -math.atan2(up, math.hypot(ahead, left))


def _rest(target: float, angle: float) -> float:
    return 0.0 if angle == target else target - angle


def _part(obj: Body, name: str) -> Body:
    for part in obj.childrenRecursive:
        if part.node.plain_name == name:
            return part
    raise ValueError(f"its model has no part '{name}': a pan-tilt unit needs a {_BASE} and on it a {_HEAD}")
