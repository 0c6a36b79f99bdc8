"""Calls of builder methods that pages make, and the settings of the environment: gravity, time, light, viewpoint.

Most take effect at once; frequency, time strategy and middlewares count from the next start of the scene on. All are
written into the script.
"""

from __future__ import annotations

import inspect
import math
from copy import copy
from datetime import UTC, datetime
from typing import TYPE_CHECKING, NamedTuple

from morse.builder import Environment, workspace
from morse.builder.assembly.spawning import call_text
from morse.builder.names.catalog import modifier_classes
from morse.builder.script import describing
from morse.core.exceptions import MorseError
from morse.core.journal import EDIT
from morse.core.reports.quoting import nearest, short
from morse.middleware.registry import installed
from morse.scene import TimeStrategies
from morse.scene.scene import Mist
from morse.viewer.describe import moving_nodes
from morse.viewer.description import PropertyDescription, SettingDescription
from morse.viewer.feeds.components import described_modifier
from morse.viewer.view_messages import ComponentSettings, Viewpoint

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from morse.scene import Scene
    from morse.scene.scene import Settings
    from morse.simulation.simulation import Simulation
    from morse.viewer.server import ViewServer

OWNER = "simulation"
"""The pseudo component whose settings these are."""

_MIDDLEWARE, _MODIFIER = "add_default_interface", "alter"
SEVERAL = (_MIDDLEWARE, _MODIFIER)
"""Methods that are called for several names."""
_SEVERAL = ("properties", "noise", "add_stream", *SEVERAL)


class Call(NamedTuple):
    """A call of a method of the builder that pages have made for a component; see `page.Configure`."""

    method: str
    values: dict[str, object]

    def key(self) -> tuple[str, str]:
        """Calls with the same key replace each other."""
        first = self.values.get("field", "") if self.method == "noise" else self.values.get("", "")
        if self.method == "properties":
            first = next(iter(self.values))
        return self.method, str(first) if self.method in _SEVERAL else ""


Calls = dict[tuple[str, str], Call]


def lines_of(calls: Calls) -> list[str]:
    """Calls as lines of a script, the properties in one of them."""
    values: dict[str, object] = {}
    for call in calls.values():
        if call.method == "properties":
            values |= call.values
    lines = [call_text("properties", values)] if values else []
    return lines + [call_text(*call) for call in calls.values() if call.method != "properties"]


_WORDS = {"list": "a list of numbers", "str": "a text", "bool": "true or false", "float": "a number"}
#: characters of a value, numbers of a list
_LONGEST, _MOST = 100, 3


class _Argument(NamedTuple):
    """An argument of a method of `Environment`.

    Attributes:
        present: its present value.
        unit, choices, low, high: as those of a property.
    """

    present: Callable[[Settings], object]
    unit: str = ""
    choices: tuple[object, ...] = ()
    low: float | None = None
    high: float | None = None


class _Setting(NamedTuple):
    """A method of `Environment`.

    Attributes:
        attribute: what it sets: an attribute of the settings of a scene, or with ``view.`` of those of its view.
        arguments: by name; the only one has none.
        is_immediate: whether a running simulation follows it.
    """

    attribute: str
    arguments: dict[str, _Argument]
    is_immediate: bool = True


def _color(present: Callable[[Settings], tuple[float, float, float] | None], usual: tuple[float, ...]) -> _Argument:
    return _Argument(lambda settings: [*(present(settings) or usual)])


def _start_date(settings: Settings) -> str:
    """The date at which simulated time begins; empty if it is not set."""
    return "" if settings.start_time is None else datetime.fromtimestamp(settings.start_time, UTC).isoformat()


PROPERTIES = "properties"
#: properties of the environment, and their units
_PROPERTY_UNITS: dict[str, str] = {
    "longitude": "deg",
    "latitude": "deg",
    "altitude": "m",
    "angle_against_north": "rad",
    "Temperature": "°C",
}

_SETTINGS = {
    "set_gravity": _Setting("gravity", {"": _Argument(lambda settings: settings.gravity, "m/s²")}),
    "set_daylight": _Setting("view.daylight", {"": _Argument(lambda one: one.view.daylight, low=0.0, high=1.0)}),
    "set_horizon_color": _Setting(
        "view.horizon_color", {"": _color(lambda one: one.view.horizon_color, (0.05, 0.22, 0.4))}
    ),
    "set_ambient_color": _Setting(
        "view.ambient_color", {"": _color(lambda one: one.view.ambient_color, (0.0, 0.0, 0.0))}
    ),
    "set_mist_settings": _Setting(
        "view.mist",
        {
            "enable": _Argument(lambda one: one.view.mist is not None and one.view.mist.enabled),
            "start": _Argument(lambda one: (one.view.mist or Mist()).start, "m", low=0.0),
            "depth": _Argument(lambda one: (one.view.mist or Mist()).depth, "m", low=0.0),
        },
    ),
    "set_camera_location": _Setting(
        "view.camera_location", {"": _Argument(lambda one: [*one.view.camera_location], "m")}
    ),
    "set_camera_rotation": _Setting(
        "view.camera_rotation", {"": _Argument(lambda one: [*one.view.camera_rotation], "rad")}
    ),
    "set_camera_speed": _Setting(
        "view.camera_speed", {"": _Argument(lambda one: one.view.camera_speed, "m/s", low=0.0)}, is_immediate=False
    ),
    "set_camera_focal_length": _Setting(
        "view.camera_focal_length",
        {"": _Argument(lambda one: one.view.camera_focal_length, "mm", low=0.0)},
        is_immediate=False,
    ),
    "simulator_frequency": _Setting(
        "frequency", {"": _Argument(lambda one: one.frequency, "Hz", low=0.1, high=10_000.0)}, is_immediate=False
    ),
    "set_time_strategy": _Setting(
        "time_strategy",
        {"": _Argument(lambda one: one.time_strategy.name, choices=tuple(one.name for one in TimeStrategies))},
        is_immediate=False,
    ),
    "set_physics_step_sub": _Setting(
        "physics_steps", {"": _Argument(lambda one: one.physics_steps, low=1)}, is_immediate=False
    ),
    "use_physics_of_1_4": _Setting("physics_of_1_4", {"": _Argument(lambda one: one.physics_of_1_4)}, False),
    "show_physics": _Setting("view.show_physics", {"": _Argument(lambda one: one.view.show_physics)}, False),
    "show_framerate": _Setting("view.show_framerate", {"": _Argument(lambda one: one.view.show_framerate)}, False),
    "show_debug_properties": _Setting(
        "view.show_debug_properties", {"": _Argument(lambda one: one.view.show_debug_properties)}, False
    ),
    "set_seed": _Setting("seed", {"": _Argument(lambda one: one.seed, low=0)}, is_immediate=False),
    "set_start_date": _Setting("start_time", {"": _Argument(_start_date)}, is_immediate=False),
    "use_relative_time": _Setting("relative_time", {"": _Argument(lambda one: one.relative_time)}, is_immediate=False),
    "set_auto_start": _Setting("auto_start", {"": _Argument(lambda one: one.auto_start)}, is_immediate=False),
    PROPERTIES: _Setting("", {name: _Argument(lambda _: 0.0, unit) for name, unit in _PROPERTY_UNITS.items()}, False),
}
METHODS = (*_SETTINGS, *SEVERAL)
"""What pages may call."""


def is_immediate(method: str) -> bool:
    """Whether a running simulation follows a setting."""
    return method in _SETTINGS and _SETTINGS[method].is_immediate


def with_call(calls: Calls, method: str, values: Mapping[str, object], *, remove: bool) -> Calls:
    """The calls of the environment with one more, or without it.

    Properties are added to those of an earlier call; other values take the place of earlier ones.

    Raises:
        MorseError: there is no such call to remove.
    """
    key = method, str(values.get("", "")) if method in SEVERAL else ""
    if remove:
        if key not in calls:
            raise MorseError(f"{short(method)} was not set in this page: change the script")
        return {one: call for one, call in calls.items() if one != key}
    earlier = calls[key].values if method == PROPERTIES and key in calls else {}
    return {one: call for one, call in calls.items() if one != key} | {key: Call(method, {**earlier, **values})}


class LiveSettings:
    """Lets a running simulation follow the settings of its environment that need no new start."""

    def __init__(self, simulation: Simulation, server: ViewServer) -> None:
        self._simulation = simulation
        self._server = server
        #: what the script has set, by method
        self._scripted: dict[str, object] = {}

    def follow(self, calls: Iterable[tuple[str, Mapping[str, object]]]) -> None:
        """Use what the script has set, and then these calls."""
        settings = self._simulation.scene.settings
        wanted = dict(self._scripted)
        for method, values in calls:
            if is_immediate(method):
                self._scripted.setdefault(method, _value_of(settings, _SETTINGS[method].attribute))
                wanted[method] = _value_of(_called(settings, method, values), _SETTINGS[method].attribute)
        changed = []
        for method, value in wanted.items():
            attribute = _SETTINGS[method].attribute
            if _value_of(settings, attribute) != value:
                owner = settings.view if attribute.startswith("view.") else settings
                setattr(owner, attribute.removeprefix("view."), value)
                changed.append(attribute)
        if not changed:
            return
        self._simulation.journal.note(EDIT, OWNER, f"settings of the environment: {', '.join(changed)}")
        if "gravity" in changed:
            self._simulation.world.rebuild(lambda _: None)
        self._server.set_scene(self._simulation.scene, moving_nodes(self._simulation.world))
        if any("camera" in one for one in changed):
            view = settings.view
            self._server.send(Viewpoint(view.camera_location, view.camera_rotation, view.camera_clip))


def _value_of(settings: Settings, attribute: str) -> object:
    owner = settings.view if attribute.startswith("view.") else settings
    value: object = getattr(owner, attribute.removeprefix("view."))
    return copy(value)


def settings_of_world(scene: Scene, own: Iterable[tuple[str, Mapping[str, object]]]) -> ComponentSettings:
    """How the environment can be set up.

    Args:
        own: methods and arguments of what pages have called.
    """
    called = dict(own)
    given: dict[str, object] = {name: scene.properties.get(name, "") for name in _PROPERTY_UNITS}
    settings = [
        _described(method, (given if method == PROPERTIES else {}) | dict(called.get(method, {})), scene.settings)
        for method in _SETTINGS
    ]
    names = [(method, str(values.get("", ""))) for method, values in own if method in SEVERAL]
    settings += [_modifier_of_all(name) for name in sorted(modifier_classes())]
    settings += [
        SettingDescription(_MIDDLEWARE, one.name, one.missing or one.purpose, later=True)
        for one in installed().values()
        if one.stream_manager
    ]
    mine = [(method, "") for method in called if method in _SETTINGS] + names
    scripted = [(_MIDDLEWARE, name) for name in scene.interfaces if (_MIDDLEWARE, name) not in names]
    return ComponentSettings(OWNER, settings, mine, scripted)


def _modifier_of_all(name: str) -> SettingDescription:
    """A modifier of all sensors, with the options of its classes: each kind of sensors has one."""
    several = [described_modifier(name, path) for path in sorted({*modifier_classes()[name].values()})]
    arguments = {argument.name: argument for one in several for argument in one.arguments}
    return SettingDescription(_MODIFIER, name, several[0].doc if several else "", [*arguments.values()], later=True)


def _described(method: str, called: Mapping[str, object], settings: Settings) -> SettingDescription:
    setting = _SETTINGS[method]
    doc = (inspect.getdoc(getattr(Environment, method)) or "").partition("\n")[0]
    arguments = []
    for name, one in setting.arguments.items():
        value = called.get(name, one.present(settings))
        # an empty field is that of a number that is not given
        kind = _kind(one.present(settings))
        if isinstance(value, list):
            value = [round(number, 4) for number in value]
        choices = [*one.choices] or None
        arguments.append(PropertyDescription(name, kind, doc, value, choices, one.unit, one.low, one.high))
    return SettingDescription(method, "", doc, arguments, later=not setting.is_immediate)


def _kind(value: object) -> str:
    kinds = {list: "list", str: "str", bool: "bool"}
    return next((word for cls, word in kinds.items() if isinstance(value, cls)), "float")


def world_line(method: str, values: Mapping[str, object]) -> str:
    """A call as it stands behind the variable of the environment in a script."""
    if method == "set_time_strategy":
        return f"set_time_strategy(TimeStrategies.{values['']})"
    return call_text(method, values)


def check_world_call(method: str, values: Mapping[str, object], settings: Settings) -> None:
    """Make a call for an environment that nobody uses.

    Raises:
        MorseError: pages may not call this, or the environment refuses the value.
    """
    if method not in METHODS:
        raise MorseError(f"'{short(method)}' is not a setting of the environment{nearest(method, list(METHODS))}")
    arguments = _SETTINGS[method].arguments if method in _SETTINGS else {}
    kinds = {name: _kind(one.present(settings)) for name, one in arguments.items()} or {"": "str"}
    if method == _MODIFIER and (modifier := str(values.get("", ""))) in modifier_classes():  # which checks the values
        names = [argument.name for argument in _modifier_of_all(modifier).arguments]
        kinds |= {name: _kind(value) for name, value in values.items() if name in names}
    if not values or not {*values} <= {*kinds}:
        takes = "one value" if {*kinds} == {""} else f"values for {', '.join(kinds)}"
        raise MorseError(f"{method} takes {takes}, not {short(dict(values))}")
    for name, given in values.items():
        if not _is_plain(given) or _kind(given) != kinds[name]:
            raise MorseError(f"{name or method} is {_WORDS[kinds[name]]}, not {short(given)}")
    value = values.get("")
    if method == "set_time_strategy" and value not in (choices := [one.name for one in TimeStrategies]):
        raise MorseError(f"the time strategy is {' or '.join(choices)}, not {short(value)}")
    if method == _MIDDLEWARE and value not in installed():
        raise MorseError(f"there is no middleware '{short(value)}'{nearest(str(value), list(installed()))}")
    try:
        _called(settings, method, values)
    except (ValueError, TypeError) as error:
        raise MorseError(str(error)) from None


def _called(settings: Settings, method: str, values: Mapping[str, object]) -> Settings:
    """The settings of an environment that nobody uses, after a call; what the call leaves is as it was."""
    named = {name: value for name, value in values.items() if name}
    value = values.get("")
    alone = (
        [] if named and "" not in values else [TimeStrategies[str(value)] if method == "set_time_strategy" else value]
    )
    with describing([]), workspace.described():
        environment = Environment("empty")
        environment.settings.view.mist = copy(settings.view.mist)
        getattr(environment, method)(*alone, **named)
        return environment.settings


def _is_plain(value: object) -> bool:
    if isinstance(value, list):
        return len(value) <= _MOST and all(isinstance(one, (int, float)) and _is_plain(one) for one in value)
    if isinstance(value, str):
        return len(value) <= _LONGEST
    if isinstance(value, bool):
        return True
    return isinstance(value, (int, float)) and abs(value) < 1e9 and math.isfinite(value)
