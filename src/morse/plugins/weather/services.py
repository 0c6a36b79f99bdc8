"""The present weather, which clients may change, and the force of the wind."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Annotated, Any
from weakref import WeakKeyDictionary

import numpy as np

from morse.actuators.drag import Drag
from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import closest
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.helpers.air import Air, Look
from morse.mathutils.portable import matmul
from morse.plugins.weather import FIXED, IN_ZONES, PROPERTY, checked, radio
from morse.plugins.weather.drawing import sky_in
from morse.plugins.weather.medium import Conditions
from morse.plugins.weather.zones import Atmosphere, is_number
from morse.scene.extent import extent

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from morse.core.context import Context
    from morse.core.interfaces import Carrier
    from morse.core.world import Body, RayBundle
    from morse.plugins.weather.zones import Zone
    from morse.scene import Node

#: s, in which a change of the weather may take place
Duration = Annotated[float, Range(0.0, 1e6, "s")]
#: kg/m^3
_AIR = 1.225
#: drag of a box: force / (pressure area)
_DRAG = 1.05
#: turbulence at an altitude of 60 feet (MIL-F-8785C, sections 3.7.1 to 3.7.3): its length along and across the wind,
#: h / (0.177 + 0.000823 h)^1.2; upward, h; the vertical standard deviation as a share of the horizontal one
_LENGTH, _LENGTH_UP, _UP = 108.7, 18.29, 0.552
_ROOT = math.sqrt(3.0)
#: heights beyond so many radii of a rotor count as free air: there, 0.1 % of the thrust are left of the ground effect
_REACH = 8.0
#: m
_LARGEST_ROTOR = 50.0


def services(context: Context) -> Weather | None:
    """Return the services of the weather, if the scene has a weather."""
    return Weather(context) if PROPERTY in context.scene.properties else None


def present(context: Context) -> Atmosphere:
    """Return the weather at the present time, everywhere."""
    for one in context.service_objects:
        if isinstance(one, Weather):
            return one.atmosphere
    return _CALM


_CLEAR = Conditions()
_CALM = Atmosphere(_CLEAR)


class _Plan:
    """The weather of one place over time.

    Attributes:
        steps: (time, conditions); the first one has passed.
    """

    def __init__(self, steps: list[tuple[float, Conditions]]) -> None:
        self.steps = steps

    @classmethod
    def of_script(cls, script: Mapping[str, Any]) -> _Plan:
        """Create the plan of a script."""
        conditions = _CLEAR.changed(script.get("first", {}))
        steps = [(0.0, conditions)]
        for time, values in script.get("later", ()):
            conditions = conditions.changed(values)
            steps.append((time, conditions))
        return cls(steps)

    def at(self, time: float) -> Conditions:
        """Return the conditions at a time, which does not decrease."""
        while len(self.steps) > 1 and self.steps[1][0] <= time:
            del self.steps[0]
        (start, before), after = self.steps[0], self.steps[1:]
        if not after or after[0][0] <= start:
            return before
        return before.mixed(after[0][1], (time - start) / (after[0][0] - start))


class Weather(AbstractObject):
    """The weather of a scene: ``weather.set`` and ``weather.get``."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self._context = context
        self._zones: list[Zone] = []
        #: those of the zones, and last that of the world outside of them
        self._plans: list[_Plan] = []
        self.atmosphere = _CALM
        self._air = context.server(Air)
        if self._script.get("ground_effect"):
            self._air.thrust = self._thrust
        self._filters = self._settled()
        #: cross-sections of robots along their axes, m^2; by the robot, because another one may get its name
        self._areas: WeakKeyDictionary[Carrier, np.ndarray] = WeakKeyDictionary()
        #: radius of the rotors of robots, m, and the ray that measures their height
        self._rotors: WeakKeyDictionary[Body, tuple[float, RayBundle]] = WeakKeyDictionary()
        self.restart()

    @property
    def _script(self) -> dict[str, Any]:
        return self._context.scene.properties[PROPERTY]  # type: ignore[return-value]

    def name(self) -> str:
        """``weather``."""
        return "weather"

    def restart(self) -> None:
        """Begin with the weather of the script."""
        zones = self._script["zones"]
        self._zones = [zone for zone, _ in zones]
        self._plans = [*(_Plan.of_script(plan) for _, plan in zones), _Plan.of_script(self._script)]
        self._filters = self._settled()
        self._follow(0.0)

    def _settled(self) -> np.ndarray:
        return settled(self._context.random_at("weather/gusts at the start").standard_normal(5))

    @service
    def set(self, values: dict[str, object], seconds: Duration = 0.0, zone: str | None = None) -> dict[str, object]:
        """Change the weather, and end the schedule of the script; return the new weather.

        Args:
            values: e.g. ``{"rain": 12.0, "wind": [3.0, 0.0]}``; a name that is not given keeps its value.
            seconds: time in which the weather changes, s.
            zone: name of a zone of the script; None for the weather outside of them.
        """
        number = self._number(zone)
        for name in values:
            if name in FIXED:
                raise MorseRPCInvokationError(f"'{name}' is set by the script alone: friction does not change in a run")
            if zone is not None and name not in IN_ZONES:
                raise MorseRPCInvokationError(f"a zone has {', '.join(IN_ZONES)} of its own, not {name!r:.60}")
        now = self._context.clock.time
        before = self._plans[number].at(now)
        after = before.changed(checked(values, MorseRPCInvokationError))
        self._plans[number] = _Plan([(now, before if seconds else after), (now + seconds, after)])
        return _described(after)

    @service(changes=False)
    def get(self, zone: str | None = None) -> dict[str, object]:
        """Return the present weather by name: that of a zone, or that outside of all zones."""
        return _described([*(one for _, one in self.atmosphere.zones), self.atmosphere.outside][self._number(zone)])

    @service(changes=False)
    def zones(self) -> list[dict[str, object]]:
        """Return the zones: ``zone``, ``area`` (corners, m), ``height`` (m, or None)."""
        heights = [zone.top if math.isfinite(zone.top) else None for zone in self._zones]
        return [
            {"zone": zone.name, "area": [list(corner) for corner in zone.corners], "height": height}
            for zone, height in zip(self._zones, heights, strict=True)
        ]

    def _number(self, name: str | None) -> int:
        names = [zone.name for zone in self._zones]
        if name is not None and name not in names:
            near = closest(name, names)
            hint = f"; did you mean '{near}'?" if near else f"; there are {', '.join(names) or 'none'}"
            raise MorseRPCInvokationError(f"the weather has no zone {name!r:.60}{hint}")
        return len(names) if name is None else names.index(name)

    def default_action(self) -> None:
        """Follow the schedule, and let the wind act."""
        self._follow(self._context.clock.time)
        outside = self.atmosphere.outside
        if any(outside.wind) or outside.gusts:
            self._blow(outside)

    def _follow(self, time: float) -> None:
        *within, outside = (plan.at(time) for plan in self._plans)
        before, self.atmosphere = self.atmosphere, Atmosphere(outside, tuple(zip(self._zones, within, strict=True)))
        if before != self.atmosphere:
            self._show()
        is_rain = any(one.rain for one in (outside, *within))
        self._air.radio_loss = self._radio_loss if is_rain else None
        self._air.radio_echo = self._radio_echo if is_rain else None
        self._air.wind = outside.wind
        # the gusts follow from the filters, also those of a restored state
        along, across, up = outputs(self._filters)
        flat = math.hypot(*outside.wind[:2])
        x, y = (part / flat for part in outside.wind[:2]) if flat else (1.0, 0.0)
        gust = (along * x - across * y, along * y + across * x, _UP * up)
        self._air.gust = tuple(outside.gusts * part for part in gust)  # type: ignore[assignment]

    def _show(self) -> None:
        """Tell views how the air looks, and the ground."""
        outside, *within = (
            Look(_colour(one), one.extinction(), one.overhead(), one.rain, one.snow) for one in self.atmosphere.media
        )
        parts = [
            one._replace(corners=zone.corners, top=zone.top if math.isfinite(zone.top) else None)
            for zone, one in zip(self._zones, within, strict=True)
        ]
        self._air.looks = () if self.atmosphere.is_clear else (outside, *parts)
        self._air.wet, self._air.snow_cover = self.atmosphere.outside.wet, self.atmosphere.outside.snow_cover

    def _radio_loss(self, frequency: float, start: np.ndarray, ends: np.ndarray) -> np.ndarray:
        ways = ends - start
        lengths = np.sqrt(ways[:, 0] ** 2 + ways[:, 1] ** 2 + ways[:, 2] ** 2)
        ways = ways / np.maximum(lengths, 1e-9)[:, None]
        return self.atmosphere.along(
            start, list(ways.T), lengths, lambda one: radio.attenuation(one, frequency) / 1000.0
        )

    def _radio_echo(self, frequency: float, place: Sequence[float]) -> float:
        return radio.echo_of_rain(self.atmosphere.at(place), frequency)

    def _thrust(self, body: Body) -> float:
        """The ground effect of a rotor: 1 / (1 - (R / 4 z)^2) (I. Cheeseman, W. Bennett, ARC R&M 3021, 1955)."""
        if body not in self._rotors:
            given, corners = body.get("RotorRadius"), extent(body.node.walk(), body.node)
            width = 0.0 if corners is None else float(corners[1][0] - corners[0][0] + corners[1][1] - corners[0][1])
            radius = float(given) if is_number(given) and 0.0 <= given <= _LARGEST_ROTOR else width / 8.0
            below = self._context.world.rays.bundle(body, [(0.0, 0.0, -1.0)], max(_REACH * radius, 1e-3), upright=True)
            self._rotors[body] = (radius, below)
        radius, below = self._rotors[body]
        if not radius:
            return 1.0
        below.refresh()
        height = max(float(below.distances[0]), 0.5 * radius)
        return 1.0 if below.hit[0] < 0 else 1.0 / (1.0 - (radius / (4.0 * height)) ** 2)

    def _blow(self, conditions: Conditions) -> None:
        period = self._context.clock.period
        speed = max(math.hypot(*conditions.wind), 1.0)
        random = self._context.random_at("weather/gusts", self._context.clock.tick)
        self._filters = turbulence(self._filters, random.standard_normal(3), period, speed)
        self._follow(self._context.clock.time)
        wind = np.asarray(conditions.wind) + np.asarray(self._air.gust)
        parts = self._context.components.values()
        drags: dict[object, Drag] = {one.robot_parent: one for one in parts if isinstance(one, Drag)}
        for robot in self._context.robots.values():
            self._push(robot, wind, drags.get(robot))

    def _push(self, robot: Carrier, wind: np.ndarray, drag: Drag | None) -> None:
        """Push a robot that touches nothing; friction holds the others, as long as no hurricane blows."""
        body = robot.bge_object
        if not body.is_dynamic or self._context.world.touched_by(body):
            return
        rotation = np.reshape(body.world_pose()[1], (3, 3))
        velocity = np.asarray(body.localLinearVelocity)
        air = matmul(wind, rotation) - velocity
        if robot not in self._areas:
            self._areas[robot] = self._cross_sections(body.node)
        force = 0.5 * _AIR * _DRAG * self._areas[robot] * np.abs(air) * air
        if drag is not None:
            # it resists as in still air, and says how much
            resistance = np.array([drag._drag_x, drag._drag_y, drag._drag_z])
            force = resistance * (np.abs(air) * air + np.abs(velocity) * velocity)
        body.wrench(tuple(force), (0.0, 0.0, 0.0), True)

    def get_state(self) -> object:
        """Return the plans of the weather, and the filters of the gusts."""
        plans = [[(time, _described(one)) for time, one in plan.steps] for plan in self._plans]
        return {"plans": plans, "gusts": self._filters.tolist()}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore a state that `get_state` returned."""
        if len(state["plans"]) != len(self._plans):
            raise ValueError("the state has other zones of weather")
        self._plans = [
            _Plan([(float(time), _CLEAR.changed(checked(values, ValueError))) for time, values in steps])
            for steps in state["plans"]
        ]
        self._filters = np.array(state["gusts"], dtype=np.float64)
        self._follow(self._context.clock.time)

    @staticmethod
    def _cross_sections(node: Node) -> np.ndarray:
        corners = extent(node.walk(), node)
        if corners is None:
            return np.zeros(3)
        x, y, z = corners[1] - corners[0]
        return np.array([y * z, x * z, x * y])


def settled(white: np.ndarray) -> np.ndarray:
    """Return a state (5,) of the filters as after a long time, from independent numbers (5,) of deviation 1.

    A filter that begins at 0 takes several times its own time, 100 s in light wind, to reach its deviation.
    """
    u, v, v_own, w, w_own = white
    # a slow filter has half of the variance of the fast one, and a covariance with it of a half
    return np.array([u, v, 0.5 * (v + v_own), w, 0.5 * (w + w_own)])


def turbulence(filters: np.ndarray, white: np.ndarray, period: float, speed: float) -> np.ndarray:
    """Return the next state of the filters, whose `outputs` are the turbulence.

    The forming filters of Dryden: 1 / (1 + T s) along the wind, (1 + sqrt(3) T s) / (1 + T s)^2 for the others, with
    the time T = length / speed. The standard deviation of each output is 1.

    Args:
        filters: (5,) state: one number along the wind, two across, two upward.
        white: (3,) independent numbers with the standard deviation 1.
        period: s.
        speed: of the wind, m/s.
    """
    u, v, v_slow, w, w_slow = filters
    keep, keep_up = math.exp(-period * speed / _LENGTH), math.exp(-period * speed / _LENGTH_UP)
    kick, kick_up = math.sqrt(1.0 - keep * keep), math.sqrt(1.0 - keep_up * keep_up)
    # the mean of the fast filter over the period moves the slow one
    v_new, w_new = keep * v + kick * white[1], keep_up * w + kick_up * white[2]
    v_slow = keep * v_slow + (1.0 - keep) * 0.5 * (v + v_new)
    w_slow = keep_up * w_slow + (1.0 - keep_up) * 0.5 * (w + w_new)
    return np.array([keep * u + kick * white[0], v_new, v_slow, w_new, w_slow])


def outputs(filters: np.ndarray) -> tuple[float, float, float]:
    """Return the turbulence along the wind, across it, and upward: numbers with the standard deviation 1."""
    u, v, v_slow, w, w_slow = filters
    across, up = ((_ROOT * fast + (1.0 - _ROOT) * slow) / math.sqrt(2.0) for fast, slow in ((v, v_slow), (w, w_slow)))
    return float(u), float(across), float(up)


def _colour(conditions: Conditions) -> tuple[float, float, float]:
    red, green, blue = sky_in(conditions)
    return red / 255.0, green / 255.0, blue / 255.0


def _described(conditions: Conditions) -> dict[str, object]:
    fog = None if math.isinf(conditions.fog) else conditions.fog
    return {**dataclasses.asdict(conditions), "fog": fog, "wind": list(conditions.wind)}
