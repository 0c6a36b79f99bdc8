"""What a component class says of itself, once: the rest is derived from it.

The functions are called in the body of a component class and write into its namespace::

    class Thermostat(Sensor):
        _name = "Thermostat"
        _short_desc = "Measures the temperature of a room"

        add_data("temperature", 0.0, "float", "Temperature of the air", unit="°C")
        add_property("_offset", 0.0, "Offset", "float", "Added to every reading, °C")
        add_level("raw", None, doc="the reading of the probe", default=True)

Builder classes, documentation, default streams and the panels of the live view come from these.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from typing import Any, NamedTuple


class DataField(NamedTuple):
    """A field of ``local_data``: what a sensor publishes or an actuator reads."""

    default: Any
    type: str
    doc: str
    level: str | tuple[str, ...]
    unit: str


class Property(NamedTuple):
    """A parameter that scripts set with ``properties(Name=...)`` and clients with ``set_property``."""

    default: Any
    name: str
    type: str
    doc: str


class Level(NamedTuple):
    """An abstraction level; ``classpath`` names the class that implements it, if another one does."""

    classpath: str | None
    doc: str
    default: bool


@dataclass(frozen=True, slots=True)
class Visual:
    """The small body that marks a component in the view.

    Attributes:
        shape: ``cube``, ``sphere`` or ``cylinder``, 2 m in size (or 1 m in radius) before the scale.
        scale: per axis.
        color: RGB, 0..1.
    """

    shape: str
    scale: tuple[float, float, float]
    color: tuple[float, float, float] = (0.8, 0.8, 0.8)


@dataclass(frozen=True, slots=True)
class BuilderDefaults:
    """What the builder class of a component starts with.

    Attributes:
        name: name in scene scripts, if it is not that of the class.
        frequency: Hz.
        properties: values that differ from the declared defaults.
        visual: a marker, or None.
        model: a model file, or None.
    """

    name: str | None = None
    frequency: float = 60.0
    properties: dict[str, Any] = field(default_factory=dict)
    visual: Visual | None = None
    model: str | None = None


def _class_namespace(function: str) -> dict[str, Any]:
    frame = sys._getframe(2)
    if "__module__" not in frame.f_locals or "__qualname__" not in frame.f_locals:
        raise SyntaxError(f"{function}() declares a part of a component: call it in the body of the class")
    return frame.f_locals


def add_data(
    name: str,
    default_value: Any,
    type: str = "",
    doc: str = "",
    level: str | list[str] | tuple[str, ...] = "all",
    *,
    unit: str = "",
) -> None:
    """Declare a field of ``local_data``.

    Args:
        level: the abstraction level or levels that have the field, or ``"all"``.
    """
    fields = _class_namespace("add_data").setdefault("_data_fields", {})
    fields[name] = DataField(default_value, type, doc, level if isinstance(level, str) else tuple(level), unit)


def add_property(python_name: str, default_value: Any, name: str, type: str = "", doc: str = "") -> None:
    """Declare a parameter; its value is the attribute ``python_name`` of the component."""
    properties = _class_namespace("add_property").setdefault("_properties", {})
    properties[python_name] = Property(default_value, name, type, doc)


def add_level(name: str, classpath: str | None, doc: str = "", default: bool = False) -> None:
    """Declare an abstraction level."""
    levels = _class_namespace("add_level").setdefault("_levels", {})
    levels[name] = Level(classpath, doc, default)


def _merged(cls: type, attribute: str) -> dict[str, Any]:
    merged: dict[str, Any] = {}
    for base in reversed(cls.__mro__):
        merged.update(vars(base).get(attribute, {}))
    return merged


def data_fields(cls: type) -> dict[str, DataField]:
    """The data fields of a class and its bases, in the order of declaration, bases first."""
    return _merged(cls, "_data_fields")


def properties(cls: type) -> dict[str, Property]:
    """The properties of a class and its bases: python name to declaration."""
    return _merged(cls, "_properties")


def levels(cls: type) -> dict[str, Level]:
    """The abstraction levels of a class and its bases."""
    return _merged(cls, "_levels")
