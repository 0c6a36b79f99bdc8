"""The description of a simulation for clients."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.core.values import JsonObject
    from morse.scene import ComponentDeclaration


def details(context: Context) -> JsonObject:
    """Return the robots with their components, services and streams, and the environment."""
    declarations = {d.name: d for d in context.scene.components}
    return {
        "robots": [_robot(context, name, robot, declarations) for name, robot in context.robots.items()],
        "environment": context.scene.environment,
    }


def _robot(context: Context, name: str, robot: object, declarations: dict[str, ComponentDeclaration]) -> JsonObject:
    description: JsonObject = {"name": name, "type": type(robot).__name__, "components": {}}
    for component_name, component in context.components.items():
        if component.robot_parent is robot:
            description["components"][component_name] = _component(context, component, declarations[component_name])
    services = _services(context, name)
    if services:
        description["services"] = services
        description["services_interfaces"] = [m.classpath for m in context.services.managers_of(name)]
    return description


def _component(context: Context, component: Object, declaration: ComponentDeclaration) -> JsonObject:
    return {
        "type": type(component).__name__,
        "services": _services(context, declaration.name),
        "service_interfaces": [m.classpath for m in context.services.managers_of(declaration.name)],
        "stream_interfaces": [[stream.manager, stream.direction] for stream in declaration.streams],
    }


def _services(context: Context, name: str) -> list[str]:
    names: list[str] = []
    for manager in context.services.managers_of(name):
        names += [service for service in manager.services().get(name, []) if service not in names]
    return names
