"""Buttons."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from morse.core.classes.builder_defaults import RobotDefaults
from morse.core.exceptions import MorseError, MorseRPCInvokationError
from morse.core.reports.quoting import nearest
from morse.core.services import service
from morse.core.validation.arguments import Arguments
from morse.helpers.components import add_data, add_property, add_state
from morse.plugins.facilities.panels import Facility, Panels

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.core.robot import Robot
    from morse.core.world import Body

#: m: a robot whose origin is farther away does not touch the cap
_FAR = 5.0
#: m: what is that near touches the cap
_TOUCH = 0.005
#: m: the floor below a button on a wall
_FLOOR = -1.5


class Button(Facility):
    """A button that calls services, each time that a robot or a person presses it."""

    _name = "Button"
    _short_desc = "A button that robots and people press, and that calls services"
    _builder = RobotDefaults(drive="free", builder="morse.plugins.facilities.builder.Button")

    add_data("pressed", False, "bool", "Whether it is pressed now")
    add_data("count", 0, "int", "How often it was pressed", low=0)
    add_data("refused", "", "string", "Why a service refused its last call; empty if none did")

    _reach: float
    _calls: str
    add_property(
        "_reach",
        0.0,
        "Reach",
        "float",
        "Distance at which somebody presses it; 0: by touch",
        unit="m",
        low=0.0,
        high=50.0,
    )
    add_property(
        "_calls",
        "[]",
        "Calls",
        "string",
        "Components, services and arguments, as JSON",
        written_by="Button.calls(component, service)",
    )

    add_state("_told", bool, "Whether a client presses it in this tick")

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._panels = Panels(self.context, obj)
        # read once: clients may change properties while the simulation runs
        self._links: list[tuple[str, str, list[object]]] = json.loads(self._calls)
        self._told = False

    def check_scene(self) -> None:
        """Check that all services exist and take their arguments.

        Raises:
            MorseError: there is no such component, or no such service, or the arguments are wrong.
        """
        for link in self._links:
            self._function(*link)

    @service
    def press(self) -> None:
        """Press the button once."""
        self._told = True

    def default_action(self) -> None:
        """Call the services when somebody begins to press."""
        data = self.local_data
        is_pressed = self._is_pressed()
        if self._told or (is_pressed and not data["pressed"]):
            data["count"] += 1
            data["refused"] = ""
            for link in self._links:
                try:
                    function = self._function(*link)
                except MorseError as error:  # it was deleted since the start
                    data["refused"] = str(error)
                    continue
                try:
                    function()
                except MorseRPCInvokationError as error:
                    data["refused"] = str(error)
        data["pressed"], self._told = is_pressed or self._told, False

    def _function(self, target: str, name: str, arguments: list[object]) -> Callable[[], object]:
        names = [*self.context.robots, *self.context.components]
        component = self.context.component(target)
        if component is None:
            raise MorseError(f"{self.name()} calls '{target:.80}', which does not exist{nearest(target, names)}")
        services = {one.name: one for one in component.services() if not one.asynchronous}
        if name not in services:
            raise MorseError(f"{self.name()}: {target} has no service '{name:.80}' to call{nearest(name, [*services])}")
        function = getattr(component, services[name].attribute)
        try:
            Arguments(function, name).check(arguments)
        except MorseRPCInvokationError as error:
            raise MorseError(f"{self.name()} calls {target}.{name}: {error}") from None
        return partial(function, *arguments)

    def _is_pressed(self) -> bool:
        if self._reach:
            near = self._panels.present(_FLOOR)
            return bool(len(near) and float((near * near).sum(axis=1).min()) < self._reach**2)
        here = np.array(self.bge_object.world_pose()[0])
        robots = (one for one in self.context.robots.values() if not isinstance(one, Facility))
        apart = [np.array(one.bge_object.world_pose()[0]) - here for one in robots]
        return any(float((one * one).sum()) < _FAR**2 for one in apart) and self._panels.is_touched(0, _TOUCH)
