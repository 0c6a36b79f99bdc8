"""The present weather, which clients may change, and the force of the wind."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Annotated
from weakref import WeakKeyDictionary

import numpy as np

from morse.actuators.drag import Drag
from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.services import service
from morse.core.validation.arguments import Range
from morse.helpers.air import Air
from morse.mathutils.portable import matmul
from morse.plugins.weather import PROPERTY, checked
from morse.plugins.weather.medium import Conditions
from morse.scene.extent import extent

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.context import Context
    from morse.core.interfaces import Carrier
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


def services(context: Context) -> Weather | None:
    """Return the services of the weather, if the scene has a weather."""
    return Weather(context) if PROPERTY in context.scene.properties else None


def present(context: Context) -> Conditions:
    """Return the weather at the present time."""
    for one in context.service_objects:
        if isinstance(one, Weather):
            return one.conditions
    return _CLEAR


_CLEAR = Conditions()


class Weather(AbstractObject):
    """The weather of a scene: ``weather.set`` and ``weather.get``."""

    def __init__(self, context: Context) -> None:
        super().__init__()
        self._context = context
        self._plan: list[tuple[float, Conditions]] = []
        self.conditions = _CLEAR
        self._air = context.server(Air)
        self._air.radio_loss = lambda frequency: self.conditions.attenuation_of_radio(frequency)
        self._filters = np.zeros(5)
        #: cross-sections of robots along their axes, m^2; by the robot, because another one may get its name
        self._areas: WeakKeyDictionary[Carrier, np.ndarray] = WeakKeyDictionary()
        self.restart()

    def name(self) -> str:
        """``weather``."""
        return "weather"

    def restart(self) -> None:
        """Begin with the weather of the script."""
        script: dict = self._context.scene.properties[PROPERTY]  # type: ignore[assignment, type-arg]
        conditions = _CLEAR.changed(script["first"])
        self._plan = [(0.0, conditions)]
        for time, values in script["later"]:
            conditions = conditions.changed(values)
            self._plan.append((time, conditions))
        self._filters = np.zeros(5)
        self._change_to(self._plan[0][1])

    @service
    def set(self, values: dict[str, object], seconds: Duration = 0.0) -> dict[str, object]:
        """Change the weather, and end the schedule of the script; return the new weather.

        Args:
            values: e.g. ``{"rain": 12.0, "wind": [3.0, 0.0]}``; a name that is not given keeps its value.
            seconds: time in which the weather changes, s.
        """
        if "wet" in values:
            raise MorseRPCInvokationError("'wet' is set by the script alone: friction does not change in a run")
        after = self.conditions.changed(checked(values, MorseRPCInvokationError))
        now = self._context.clock.time
        self._plan = [(now, self.conditions if seconds else after), (now + seconds, after)]
        return _described(after)

    @service(changes=False)
    def get(self) -> dict[str, object]:
        """Return the present weather by name."""
        return _described(self.conditions)

    def default_action(self) -> None:
        """Follow the schedule, and let the wind act."""
        self._follow(self._context.clock.time)
        if any(self.conditions.wind) or self.conditions.gusts:
            self._blow()

    def _follow(self, time: float) -> None:
        before, after = self._plan[0], self._plan[0]
        while len(self._plan) > 1 and self._plan[1][0] <= time:
            before = after = self._plan.pop(1)
            self._plan[0] = before
        if len(self._plan) > 1 and self._plan[1][0] > self._plan[0][0]:
            after = self._plan[1]
            share = (time - before[0]) / (after[0] - before[0])
            self._change_to(before[1].mixed(after[1], share))
        else:
            self._change_to(before[1])

    def _change_to(self, conditions: Conditions) -> None:
        self.conditions = conditions
        self._air.wind = conditions.wind
        # the gusts follow from the filters, also those of a restored state
        along, across, up = outputs(self._filters)
        flat = math.hypot(*conditions.wind[:2])
        x, y = (part / flat for part in conditions.wind[:2]) if flat else (1.0, 0.0)
        gust = (along * x - across * y, along * y + across * x, _UP * up)
        self._air.gust = tuple(conditions.gusts * part for part in gust)  # type: ignore[assignment]

    def _blow(self) -> None:
        conditions, period = self.conditions, self._context.clock.period
        speed = max(math.hypot(*conditions.wind), 1.0)
        random = self._context.random_at("weather/gusts", self._context.clock.tick)
        self._filters = turbulence(self._filters, random.standard_normal(3), period, speed)
        self._change_to(conditions)
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
        """Return the plan of the weather, and the filters of the gusts."""
        return {"plan": [(time, _described(one)) for time, one in self._plan], "gusts": self._filters.tolist()}

    def set_state(self, state: Mapping[str, object]) -> None:
        """Restore a state that `get_state` returned."""
        plan: list = state["plan"]  # type: ignore[assignment, type-arg]
        self._plan = [(float(time), _CLEAR.changed(checked(values, ValueError))) for time, values in plan]
        self._filters = np.array(state["gusts"], dtype=np.float64)
        self._follow(self._context.clock.time)

    @staticmethod
    def _cross_sections(node: Node) -> np.ndarray:
        corners = extent(node.walk(), node)
        if corners is None:
            return np.zeros(3)
        x, y, z = corners[1] - corners[0]
        return np.array([y * z, x * z, x * y])


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


def _described(conditions: Conditions) -> dict[str, object]:
    fog = None if math.isinf(conditions.fog) else conditions.fog
    numbers = {name: getattr(conditions, name) for name in ("rain", "snow", "dust", "gusts", "wet")}
    return {"fog": fog, **numbers, "wind": list(conditions.wind)}
