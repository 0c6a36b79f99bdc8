"""Finds injured people, and heals them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from morse.core import status
from morse.core.declarations import BuilderDefaults, Visual
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.sensor import Sensor, WatchedSpace
from morse.core.services import async_service, noninterruptible, service
from morse.helpers.components import add_data, add_property, add_state
from morse.mathutils.portable import matmul
from morse.scene.extent import corners

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.world import Body


#: distance below which shapes touch, m
_TOUCH = 1e-3
_STEPS = 200


class Cone:
    """The points within ``length`` of the origin whose direction differs from X by at most ``half_angle``.

    Args:
        half_angle: rad.
        length: m.
    """

    def __init__(self, half_angle: float, length: float) -> None:
        self._angle = half_angle
        self._length = length
        self._tangent = (math.cos(half_angle), math.sin(half_angle))

    def contains(self, point: NDArray[np.float64]) -> bool:
        """Whether a point (3,) is in the cone."""
        distance = math.sqrt(_dot(point, point))
        inside = distance == 0.0 or math.acos(max(-1.0, min(1.0, float(point[0]) / distance))) <= self._angle
        return inside and distance <= self._length

    def touches(self, points: NDArray[np.float64]) -> bool:
        """Whether the convex hull of points (P, 3) has a point in the cone.

        The point of the hull that is nearest to the cone is approached by the method of Frank and Wolfe, whose gap
        shows early that hull and cone are apart. A cone wider than a half space is not convex: then the points are
        tested alone.
        """
        if any(self.contains(point) for point in points):
            return True
        if self._angle >= 0.5 * math.pi:
            return False
        here = points.mean(axis=0)
        for _ in range(_STEPS):
            away = here - self._nearest(here)
            squared = _dot(away, away)
            if squared <= _TOUCH * _TOUCH:
                return True
            towards = points[int(np.argmin(matmul(points, away)))] - here
            gap = -_dot(away, towards)
            if gap < 0.5 * squared or gap <= 0.0:
                return False
            here = here + min(1.0, gap / _dot(towards, towards)) * towards
        return False

    def _nearest(self, point: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the point of the cone that is nearest to a point."""
        aside = math.hypot(point[1], point[2])
        cosine, sine = self._tangent
        if math.atan2(aside, float(point[0])) > self._angle:
            along = max(0.0, float(point[0]) * cosine + aside * sine)
            share = along * sine / aside if aside else 0.0
            point = np.array([along * cosine, share * point[1], share * point[2]])
        distance = math.sqrt(_dot(point, point))
        return point if distance <= self._length else point * (self._length / distance)


def _dot(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    a, b, c = (one * other).tolist()
    return float(a + b + c)


#: number of measurements that healing takes
_HEALING = 10
_POSE = ((3,), (3, 3))
_INJURED, _SEVERITY, _REQUIREMENTS = "Injured", "Severity", "Requirements"


class SearchAndRescue(Sensor):
    """Finds objects with a true property ``Injured`` in a cone around its X axis, even behind walls.

    An object is found if a part of its collision shape is in the cone. Victims have the properties ``Requirements``,
    numbers of abilities joined by commas, and ``Severity``. The sensor can heal the nearest victim, if it is near
    enough and one of the abilities of the robot is among its requirements. The victim then no longer has the
    requirements that the robot can treat; without any, its severity is 0.
    """

    _name = "Search and rescue"
    _short_desc = "A sensor that finds victims, and heals them"
    _builder = BuilderDefaults(
        frequency=6.0,
        properties={"Heal_range": 2.0, "Abilities": "1,2"},
        visual=Visual("cube", (0.04, 0.04, 0.02), (0.9, 0.9, 0.9)),
    )

    add_data(
        "victim_dict",
        {},
        "dict",
        "Name of each victim to its coordinate {x, y, z} (m, in the world), requirements [int] and severity (int)",
    )
    add_property(
        "_heal_range", 5.0, "Heal_range", "float", "Largest distance of a victim for healing", unit="m", low=0.0
    )
    add_property("_abilities", "", "Abilities", "string", "Numbers of the abilities of the robot, joined by commas")
    add_property("_angle", 60.0, "Angle", "float", "Full angle of the cone", unit="deg", low=0.0, high=360.0)
    add_property("_distance", 10.0, "Distance", "float", "Length of the cone", unit="m", low=0.0)
    add_property("_freq", 3.0, "Freq", "float", "Exists for scripts of 1.4; use frequency(...)", low=0.0)

    add_state("_left", int, "Number of measurements until the victim is healed")
    add_state("_patient", str | None, "Name of the victim that is healed")

    _heal_range: float
    _abilities: str
    _angle: float
    _distance: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._patient: str | None = None
        self._left = 0

    def watched_space(self) -> WatchedSpace:
        """Return the cone."""
        return WatchedSpace(self._distance, math.radians(self._angle), tuple(self.local_data["victim_dict"]))

    # -- victims ---------------------------------------------------------------------------

    def _is_in(self, cone: Cone, victim: Body) -> bool:
        """Whether a part of the collision shape of a victim, or else its origin, is in the cone."""
        position, rotation = self.position_3d.get_pose()
        here, rotation_rows = np.array(position), np.reshape(rotation, (3, 3))
        has_shape = False
        for node in victim.node.walk():
            part = self.context.world.find_object(node) if node.shapes else None
            if part is None:
                continue
            place, own = (np.reshape(values, shape) for values, shape in zip(part.world_pose(), _POSE, strict=True))
            for shape in node.shapes or ():
                has_shape = True
                if cone.touches(matmul(corners(shape, place, own) - here, rotation_rows)):
                    return True
        return not has_shape and cone.contains(matmul(np.array(victim.world_pose()[0]) - here, rotation_rows))

    def _victims(self) -> list[tuple[float, Body]]:
        """Return object and distance between the origins of each victim in the cone, the nearest first."""
        own, cone = self.robot_parent.bge_object, Cone(0.5 * math.radians(self._angle), self._distance)
        here = self.position_3d.get_pose()[0]
        victims = [
            (math.dist(here, obj.world_pose()[0]), obj)
            for obj in self.context.world.objects()
            if obj.properties.get(_INJURED) and obj is not own and self._is_in(cone, obj)
        ]
        return sorted(victims, key=lambda item: item[0])

    def measure(self) -> None:
        """Find the victims, and continue healing."""
        victims = self._victims()
        if self._patient is not None:
            self._go_on(victims)
        visible = {}
        for _, obj in victims:
            x, y, z = obj.world_pose()[0]
            visible[obj.name] = {
                "coordinate": {"x": x, "y": y, "z": z},
                "requirements": _numbers(obj.get(_REQUIREMENTS)),
                "severity": _severity(obj),
            }
        self.local_data["victim_dict"] = visible

    def _nearest(self) -> tuple[float, Body]:
        self.update_pose()
        victims = self._victims()
        if not victims:
            raise MorseRPCInvokationError(f"{self.name()} detects no victim")
        return victims[0]

    # -- services --------------------------------------------------------------------------

    @service(changes=False)
    def get_robot_abilities(self) -> list[int]:
        """The numbers of the abilities of the robot."""
        return _numbers(self._abilities)

    @service(changes=False)
    def get_victim_requirements(self) -> list[int]:
        """The requirements of the nearest victim in the cone."""
        return _numbers(self._nearest()[1].get(_REQUIREMENTS))

    @service(changes=False)
    def get_victim_severity(self) -> int:
        """The severity of the injuries of the nearest victim in the cone."""
        return _severity(self._nearest()[1])

    @noninterruptible
    @async_service
    def heal(self) -> None:
        """Heal the nearest victim in the cone; this takes ten measurements.

        It fails if the victim is farther away than ``Heal_range``, now or before the end, or if the robot has none of
        the abilities that the victim requires.
        """
        try:
            distance, victim = self._nearest()
        except MorseRPCInvokationError as error:
            self.completed(status.FAILED, str(error))
            return
        requirements = _numbers(victim.get(_REQUIREMENTS))
        if distance > self._heal_range:
            reason = f"'{victim.name}' is {distance:.2f} m away, farther than Heal_range, {self._heal_range:g} m"
            self.completed(status.FAILED, reason)
        elif requirements and not set(requirements) & set(_numbers(self._abilities)):
            reason = f"'{victim.name}' requires one of the abilities {requirements}, the robot has {self._abilities!r}"
            self.completed(status.FAILED, reason)
        else:
            self._patient, self._left = victim.name, _HEALING

    def interrupt(self) -> None:
        """Stop healing."""
        self._patient = None
        super().interrupt()

    def _go_on(self, victims: list[tuple[float, Body]]) -> None:
        patient = next((item for item in victims if item[1].name == self._patient), None)
        if patient is None or patient[0] > self._heal_range:
            name, self._patient = self._patient, None
            self.completed(status.FAILED, f"'{name}' is no longer within reach")
            return
        victim = patient[1]
        self._left -= 1
        if self._left == 0:
            needs = [need for need in _numbers(victim.get(_REQUIREMENTS)) if need not in _numbers(self._abilities)]
            victim[_REQUIREMENTS] = ",".join(map(str, needs))
            if not needs:
                victim[_SEVERITY] = 0
            self._patient = None
            self.completed(status.SUCCESS, victim.name)


def _numbers(text: object) -> list[int]:
    """Parse integers joined by commas; other parts are ignored."""
    words = str("" if text is None else text).replace("[", "").replace("]", "").split(",")
    return [int(word) for word in map(str.strip, words) if word.lstrip("+-").isdecimal()]


def _severity(victim: Body) -> int:
    value = victim.get(_SEVERITY, 0)
    return int(value) if isinstance(value, (int, float)) and math.isfinite(value) else 0
