"""The settings of the environment that pages change: gravity, time, light and the viewpoint, as calls of its methods.

They are written into the script, and count from the next start of the scene on.
"""

from __future__ import annotations

import inspect
import math
from typing import TYPE_CHECKING, NamedTuple

from morse.builder import Environment, workspace
from morse.builder.assembly.spawning import call_text
from morse.builder.script import describing
from morse.core.exceptions import MorseError
from morse.core.reports.quoting import nearest, short
from morse.middleware.registry import installed
from morse.scene import TimeStrategies
from morse.viewer.description import PropertyDescription, SettingDescription
from morse.viewer.view_messages import ComponentSettings

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from morse.scene import Scene

OWNER = "simulation"
"""The pseudo component whose settings these are."""

SEVERAL = ("add_default_interface",)
"""Methods that are called for several names."""

#: characters of a value, numbers of a list
_LONGEST, _MOST = 100, 3


class _Setting(NamedTuple):
    """A method of `Environment` with one argument.

    Attributes:
        present: its present value.
        unit, choices, low, high: as those of a property.
    """

    present: Callable[[Scene], object]
    unit: str = ""
    choices: tuple[object, ...] = ()
    low: float | None = None
    high: float | None = None


_SETTINGS = {
    "set_gravity": _Setting(lambda scene: scene.settings.gravity, "m/s²"),
    "simulator_frequency": _Setting(lambda scene: scene.settings.frequency, "Hz", low=0.1, high=10_000.0),
    "set_time_strategy": _Setting(
        lambda scene: scene.settings.time_strategy.name, choices=tuple(one.name for one in TimeStrategies)
    ),
    "set_horizon_color": _Setting(lambda scene: [*(scene.settings.view.horizon_color or (0.05, 0.22, 0.4))]),
    "set_daylight": _Setting(lambda scene: scene.settings.view.daylight, low=0.0, high=1.0),
    "set_camera_location": _Setting(lambda scene: [*scene.settings.view.camera_location], "m"),
    "set_camera_rotation": _Setting(lambda scene: [*scene.settings.view.camera_rotation], "rad"),
}
METHODS = (*_SETTINGS, *SEVERAL)
"""What pages may call."""


def settings_of_world(scene: Scene, own: Iterable[tuple[str, Mapping[str, object]]]) -> ComponentSettings:
    """How the environment can be set up.

    Args:
        own: methods and arguments of what pages have called.
    """
    called = {method: values.get("") for method, values in own}
    settings = [_described(method, called.get(method, one.present(scene))) for method, one in _SETTINGS.items()]
    names = [str(values.get("", "")) for method, values in own if method in SEVERAL]
    settings += [
        SettingDescription("add_default_interface", one.name, one.missing or one.purpose)
        for one in installed().values()
        if one.stream_manager
    ]
    mine = [(method, "") for method in called if method in _SETTINGS] + [("add_default_interface", n) for n in names]
    scripted = [("add_default_interface", name) for name in scene.interfaces if name not in names]
    return ComponentSettings(OWNER, settings, mine, scripted)


def _described(method: str, value: object) -> SettingDescription:
    setting = _SETTINGS[method]
    doc = (inspect.getdoc(getattr(Environment, method)) or "").partition("\n")[0]
    if isinstance(value, list):
        value = [round(number, 4) for number in value]
    kind = "list" if isinstance(value, list) else "str" if isinstance(value, str) else "float"
    choices = [*setting.choices] or None
    argument = PropertyDescription("", kind, doc, value, choices, setting.unit, setting.low, setting.high)
    return SettingDescription(method, "", doc, [argument])


def world_line(method: str, values: Mapping[str, object]) -> str:
    """A call as it stands behind the variable of the environment in a script."""
    if method == "set_time_strategy":
        return f"set_time_strategy(TimeStrategies.{values['']})"
    return call_text(method, values)


def check_world_call(method: str, values: Mapping[str, object]) -> None:
    """Make a call for an environment that nobody uses.

    Raises:
        MorseError: pages may not call this, or the environment refuses the value.
    """
    if method not in METHODS:
        raise MorseError(f"'{short(method)}' is no setting of the environment{nearest(method, list(METHODS))}")
    value = values.get("")
    if {*values} != {""} or not _is_plain(value):
        raise MorseError(f"{method} takes one plain value, not {short(dict(values))}")
    if method == "set_time_strategy":
        names = [one.name for one in TimeStrategies]
        if value not in names:
            raise MorseError(f"the time strategy is {' or '.join(names)}, not {short(value)}")
        value = TimeStrategies[str(value)]
    if method in SEVERAL and value not in installed():
        raise MorseError(f"there is no middleware '{short(value)}'{nearest(str(value), list(installed()))}")
    try:
        with describing([]), workspace.described():
            getattr(Environment("empty"), method)(value)
    except (ValueError, TypeError) as error:
        raise MorseError(str(error)) from None


def _is_plain(value: object) -> bool:
    if isinstance(value, list):
        return len(value) <= _MOST and all(isinstance(one, (int, float)) and _is_plain(one) for one in value)
    if isinstance(value, str):
        return len(value) <= _LONGEST
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 1e9 and math.isfinite(value)
