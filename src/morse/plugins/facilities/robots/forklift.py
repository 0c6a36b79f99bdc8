"""Forklifts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.robot import Robot
from morse.core.services import async_service, interruptible, service
from morse.core.status import FAILED, SUCCESS
from morse.core.validation.arguments import Range
from morse.helpers.components import add_data, add_property, add_state
from morse.helpers.joint_motors import JointMotors
from morse.plugins.facilities.panels import travel
from morse.scene import Control

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.world import Body

#: joint of the mast, and the link that it moves
_LIFT, _FORK = "lift", "fork"
#: the sensor of the forces on the fork, which its builder class appends
_SENSOR = "scales"
#: m: the highest place of the fork; nearer than the second one, it has arrived
_HIGHEST, _NEAR = 1.7, 0.005
#: s: time constant of the load; by which share of the capacity it may be wrong
_SCALE, _TOLERANCE = 0.2, 0.03
#: 1/s: speed of the fork for a distance from its setpoint
_GAIN = 10.0
#: m: what is nearer to the fork touches it
_TOUCHING = 0.005
#: s: a fork that has not arrived that long after its setpoint is held by something
_PATIENCE = 2.0


class Forklift(Robot):
    """A forklift, driven by its front wheels and steered at the rear, with a mast that lifts a fork for pallets.

    What it carries lies on the fork, held by friction alone. The load is the vertical force of all contacts of the
    fork, divided by g, at the end of the last tick. A fork whose load is above the capacity goes down again, and its
    service fails.
    """

    _name = "Forklift"
    _short_desc = "A forklift that steers at the rear and carries pallets on its fork"
    _builder = RobotDefaults("forklift", builder="morse.plugins.facilities.handling.Forklift")

    add_data("height", 0.0, "float", "Height of the fork above its lowest place", unit="m")
    add_data("load", 0.0, "float", "Mass on the fork, by the force of its contacts", unit="kg")
    add_data("state", "stopped", "string", "stopped, up, down or overloaded")

    _capacity: float
    _speed: float
    _acceleration: float
    add_property("_capacity", 1000.0, "Capacity", "float", "Largest load", unit="kg", low=0.0, high=1500.0)
    add_property("_speed", 0.3, "Speed", "float", "Speed of the fork", unit="m/s", low=0.01, high=1.0)
    add_property("_acceleration", 0.3, "Acceleration", "float", "Acceleration of the fork", unit="m/s^2", low=0.05,
                 high=2.0)  # fmt: skip

    add_state("_setpoint", float, "Where the motor of the mast is to hold the fork, m")
    add_state("_rate", float, "Speed of the setpoint, m/s")
    add_state("_target", float, "Where the setpoint goes, m")
    add_state("_late", float, "Time for which the fork has not followed its setpoint, s")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._mast = JointMotors(obj, (_LIFT,), Control.VELOCITY)
        parts = {part.node.plain_name: part for part in obj.childrenRecursive}
        self._fork = parts[_FORK]
        self._setpoint = self._rate = self._target = self._late = 0.0

    @interruptible
    @async_service
    def lift(self, height: Annotated[float, Range(0.0, _HIGHEST, "m")]) -> None:
        """Move the fork; the service ends when the fork has arrived.

        It fails if the load is above the capacity, and the fork then goes down, or if something holds the fork.

        Args:
            height: above its lowest place, m.
        """
        if height > self.local_data["height"] and self._is_overloaded():
            raise MorseRPCInvokationError(self._refusal())
        self._target, self._late = height, 0.0

    @service(changes=False)
    def objects(self) -> list[str]:
        """Names of the objects that touch the fork, such as a pallet that lies on it."""
        near: Sequence[Body] = self.context.world.touched_by(self._fork, _TOUCHING)
        return sorted(one.name for one in near if one.is_dynamic)

    def interrupt(self) -> None:
        """Stop the fork where it is."""
        self._stop()
        super().interrupt()

    def default_action(self) -> None:
        """Measure the load, and move the fork by a tick."""
        data, period = self.local_data, self.clock.period
        (data["height"],) = self._mast.positions()
        self._weigh(period)
        self._setpoint, self._rate = travel(
            self._setpoint, self._rate, self._target, (self._speed, self._acceleration), period
        )
        # the motor of the mast follows a speed: steps of a position would shake the load
        self._mast.tell([self._rate + _GAIN * (self._setpoint - data["height"])])
        data["state"] = "stopped" if not self._rate else "up" if self._rate > 0.0 else "down"
        if self._is_overloaded():
            data["state"] = "overloaded"
            self._target = 0.0
            self._end(FAILED, self._refusal())
        elif self._setpoint == self._target:
            self._arrive(period)

    def _arrive(self, period: float) -> None:
        """End the service, if the fork is where its setpoint is."""
        if abs(self.local_data["height"] - self._setpoint) < _NEAR:
            self._late = 0.0
            self._end(SUCCESS)
            return
        self._late += period
        if self._late > _PATIENCE and self.on_completion is not None:
            height = self.local_data["height"]
            self._stop()
            self._end(FAILED, f"{self.name()}: something holds the fork at {height:.2f} m")

    def _end(self, outcome: str, message: str | None = None) -> None:
        if self.on_completion is not None:
            self.completed(outcome, message)

    def _stop(self) -> None:
        self._setpoint = self._target = min(max(float(self.local_data["height"]), 0.0), _HIGHEST)
        self._rate = self._late = 0.0

    def _weigh(self, period: float) -> None:
        """Follow the mass on the fork, as the sensor of the fork has measured it at the end of the last tick."""
        scales = self.context.component(f"{self.name()}.{_SENSOR}")
        gravity = self.context.scene.settings.gravity
        if scales is not None and gravity > 0.0:
            mass = max(-float(scales.local_data["force"][2]) / gravity, 0.0)
            self.local_data["load"] += (mass - self.local_data["load"]) * min(period / _SCALE, 1.0)

    def _is_overloaded(self) -> bool:
        return bool(self.local_data["load"] > (1.0 + _TOLERANCE) * self._capacity + 1.0)

    def _refusal(self) -> str:
        return f"{self.name()}: the load is above its capacity of {self._capacity:g} kg: the fork goes down"
