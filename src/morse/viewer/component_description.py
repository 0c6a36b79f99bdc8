"""What a page knows of the components: their data, properties and services."""

from __future__ import annotations

from typing import Any

from msgspec import Struct


class FieldDescription(Struct, frozen=True):
    """A data field of a component with its limits ``low`` and ``high``."""

    name: str
    type: str = ""
    doc: str = ""
    unit: str = ""
    low: float | None = None
    high: float | None = None


class PropertyDescription(Struct, frozen=True):
    """A property of a component with its present value; ``choices`` are its allowed values, if they are few."""

    name: str
    type: str = ""
    doc: str = ""
    value: Any = None
    choices: list[object] | None = None
    unit: str = ""
    low: float | None = None
    high: float | None = None


class ArgumentDescription(Struct, frozen=True):
    """An argument of a service; ``default`` is in Python notation, None if the argument is required."""

    name: str
    type: str = ""
    default: str | None = None


class ServiceDescription(Struct, frozen=True):
    """A service of a component."""

    name: str
    doc: str = ""
    arguments: list[ArgumentDescription] = []
    asynchronous: bool = False


class ComponentDescription(Struct, frozen=True):
    """A robot, sensor or actuator.

    Attributes:
        name: fully qualified; also the name of its node in the scene.
        kind: ``robot``, ``external_robot``, ``sensor`` or ``actuator``.
        robot: the name of its robot.
        title: name of its class, for display.
        frequency: Hz.
    """

    name: str
    kind: str
    robot: str
    title: str = ""
    doc: str = ""
    frequency: float = 0.0
    level: str = ""
    active: bool = True
    data: list[FieldDescription] = []
    properties: list[PropertyDescription] = []
    services: list[ServiceDescription] = []
