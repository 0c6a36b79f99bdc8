"""Describes the components of a simulation for the live view, from their declarations."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING

from morse.core.actuator import Actuator
from morse.core.declarations import fields_of_component, properties
from morse.core.rows.lazy_data import present_data
from morse.core.services import signature_of
from morse.viewer.component_description import (
    ArgumentDescription,
    ComponentDescription,
    FieldDescription,
    PropertyDescription,
    ServiceDescription,
)

if TYPE_CHECKING:
    from morse.core.abstractobject import AbstractObject
    from morse.core.context import Context
    from morse.core.interfaces import Component, Offering


def component_tree(context: Context) -> list[ComponentDescription]:
    """Robots, each followed by its components; then the pseudo components that only have services."""
    kinds = {d.name: d.kind for d in context.scene.components}
    tree = []
    for name, robot in context.robots.items():
        tree.append(_component(robot, "robot", name))
        for component_name, component in context.components.items():
            if component.robot_parent is robot:
                tree.append(_component(component, kinds[component_name], name))
    return tree + _pseudo_components(context)


def keyboard_robots(context: Context) -> list[str]:
    """The robots that can be driven by keys or a gamepad."""
    components = context.components.values()
    names = [c.robot_parent.name() for c in components if isinstance(c, Actuator) and c.obeys_controls]
    return list(dict.fromkeys(names))


def _pseudo_components(context: Context) -> list[ComponentDescription]:
    """Describe pseudo components that only have services; several objects may share a name."""
    parts: dict[str, list[AbstractObject]] = {}
    for obj in context.service_objects:
        parts.setdefault(obj.name(), []).append(obj)
    return [
        ComponentDescription(
            name,
            "service",
            "",
            name.capitalize(),
            _first_line(objects[0]),
            services=[service for obj in objects for service in _services(obj)],
        )
        for name, objects in parts.items()
    ]


def _component(component: Component, kind: str, robot: str) -> ComponentDescription:
    # nobody keeps them: the sensor goes on to measure when it is read
    cls, data = type(component), present_data(component)
    return ComponentDescription(
        name=component.name(),
        kind=kind,
        robot=robot,
        title=getattr(component, "_name", cls.__name__),
        doc=getattr(component, "_short_desc", "") or _first_line(component),
        frequency=component.frequency,
        level=component.level or "",
        active=component.active,
        data=[
            FieldDescription(name, field.type, field.doc, field.unit, *_bounds(field))
            for name, field in fields_of_component(component).items()
            if name in data
        ],
        properties=[
            PropertyDescription(
                p.name,
                p.type,
                p.doc,
                getattr(component, python_name),
                list(getattr(p, "choices", None) or ()) or None,
                getattr(p, "unit", ""),
                *_bounds(p),
            )
            for python_name, p in properties(cls).items()
        ],
        services=_services(component),
    )


def _bounds(declaration: object) -> tuple[float | None, float | None]:
    """The declared minimum and maximum of a field or property, or None."""
    low, high = getattr(declaration, "low", None), getattr(declaration, "high", None)
    plain = (int, float)
    return low if isinstance(low, plain) else None, high if isinstance(high, plain) else None


def _services(obj: Offering) -> list[ServiceDescription]:
    descriptions = []
    for declaration in obj.services():
        method = getattr(obj, declaration.attribute)
        arguments = [
            ArgumentDescription(
                p.name,
                "" if p.annotation is p.empty else str(p.annotation),
                None if p.default is p.empty else repr(p.default),
            )
            for p in signature_of(method).parameters.values()
        ]
        descriptions.append(
            ServiceDescription(declaration.name, inspect.getdoc(method) or "", arguments, declaration.asynchronous)
        )
    return descriptions


def _first_line(obj: object) -> str:
    return (inspect.getdoc(type(obj)) or "").partition("\n")[0]
