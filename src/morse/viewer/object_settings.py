"""The settings of an object that a page has added: methods of its class of the builder."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, NamedTuple

from morse.builder.assembly.spawning import OBJECT_CALLS
from morse.builder.components.matter import COMMON_TYPES, Matter
from morse.viewer.description import PropertyDescription, SettingDescription
from morse.viewer.view_messages import ComponentSettings

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.scene import Node


class _Range(NamedTuple):
    """The unit of a number, and its bounds; None for no bound."""

    unit: str = ""
    low: float | None = 0.0
    high: float | None = None


_SHARE = _Range(high=1.0)
#: ranges of the arguments, by method
_RANGES = {
    "color": _SHARE,
    "set_mass": _Range("kg"),
    "set_friction": _Range(),
    "set_restitution": _SHARE,
    "set_damping": _SHARE,
}


def _present(method: str, node: Node) -> list[object]:
    """The values of the arguments of a method, as an object has them."""
    body = node.body
    if method == "color":
        material = node.materials[0] if node.materials else None
        return [round(float(part), 4) for part in (material.color if material is not None else (0.0, 0.0, 0.0, 1.0))]
    values: dict[str, list[object]] = {
        "set_physics_type": [body.type.value],
        "set_mass": [body.mass],
        "set_friction": [body.friction],
        "set_restitution": [body.restitution],
        "set_damping": [body.linear_damping, body.angular_damping],
    }
    return values[method]


def _methods(cls: type[AbstractComponent]) -> list[str]:
    """The methods that an object of a class has."""
    return [one for one in OBJECT_CALLS if hasattr(cls, one)] if issubclass(cls, Matter) else []


def _names(cls: type[AbstractComponent], method: str) -> list[str]:
    """The names of the arguments of a method; the only one is given without its name."""
    names = [*inspect.signature(getattr(cls, method)).parameters][1:]
    return names if len(names) > 1 else [""]


def settings_of_object(
    name: str, cls: type[AbstractComponent], node: Node, own: Iterable[tuple[str, Mapping[str, object]]]
) -> ComponentSettings | None:
    """How an object can be set up; None if it has no body and no colour.

    Args:
        name: of the object.
        cls: its class of the builder.
        node: of the object, whose present values are shown.
        own: methods and arguments of what pages have called.
    """
    if not (methods := _methods(cls)):
        return None
    settings = []
    for method in methods:
        doc = (inspect.getdoc(getattr(cls, method)) or "").partition("\n")[0]
        around = _RANGES.get(method, _Range(low=None))
        choices: list[object] | None = [*COMMON_TYPES] if method == "set_physics_type" else None
        arguments = [
            PropertyDescription(
                argument, "str" if choices else "float", doc, value, choices, around.unit, around.low, around.high
            )
            for argument, value in zip(_names(cls, method), _present(method, node), strict=True)
        ]
        settings.append(SettingDescription(method, "", doc, arguments))
    return ComponentSettings(name, settings, [(method, "") for method, _ in own], [])


def whole_call(
    cls: type[AbstractComponent], node: Node, method: str, values: Mapping[str, object]
) -> dict[str, object] | None:
    """All arguments of a method: those that a page does not give are as they are; None if there is no such method."""
    if method not in _methods(cls):
        return None
    return dict(zip(_names(cls, method), _present(method, node), strict=True)) | dict(values)
