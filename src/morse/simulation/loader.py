"""Makes the running components of a scene."""

from __future__ import annotations

import logging
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from morse.core.classpath import load_class
from morse.core.declarations import levels
from morse.core.exceptions import MorseError
from morse.core.realism import Realism
from morse.core.robot import Robot
from morse.scene.realism import RealismModel
from morse.simulation.faults import describe

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.object import Object
    from morse.scene import ComponentDeclaration

logger = logging.getLogger("morse." + __name__)


class LoadError(MorseError):
    """A component of the scene cannot be made."""


@dataclass(eq=False)
class Loaded:
    """What came out of the declarations.

    Attributes:
        robots, actuators, sensors: in the order of the scene.
        modifiers: class paths in use.
    """

    robots: list[Robot] = field(default_factory=list)
    actuators: list[Object] = field(default_factory=list)
    sensors: list[Object] = field(default_factory=list)
    modifier_objects: list[Any] = field(default_factory=list)
    modifiers: list[str] = field(default_factory=list)


def load_components(context: Context) -> Loaded:
    """Instantiate robots, then sensors and actuators, and connect them.

    Raises:
        LoadError: naming the component and the line of the script that made it.
    """
    loaded = Loaded()
    by_node: dict[Any, Robot] = {}
    for declaration in context.scene.components:
        if declaration.kind in ("robot", "external_robot"):
            robot = _make(context, declaration, None)
            if not isinstance(robot, Robot):
                raise LoadError(
                    f"{_where(declaration)}: {declaration.classpath} is no subclass of morse.core.robot.Robot"
                )
            by_node[declaration.node] = robot
            own = declaration.kind == "robot"
            (context.robots if own else context.external_robots)[declaration.name] = robot
            if own:
                loaded.robots.append(robot)
    for declaration in context.scene.components:
        if declaration.kind in ("robot", "external_robot") or declaration.robot not in by_node:
            continue
        component = _make(context, declaration, by_node[declaration.robot])
        context.components[declaration.name] = component
        (loaded.sensors if declaration.kind == "sensor" else loaded.actuators).append(component)
    _connect(context, loaded)
    return loaded


def _where(declaration: ComponentDeclaration) -> str:
    place = f" ({declaration.where})" if declaration.where else ""
    return f"{declaration.kind} '{declaration.name}'{place}"


def _make(context: Context, declaration: ComponentDeclaration, robot: Robot | None) -> Any:
    obj = context.world.object_of(declaration.node)
    if declaration.frequency is not None:
        obj["frequency"] = declaration.frequency
    if declaration.level is not None:
        obj["abstraction_level"] = declaration.level
    try:
        cls = load_class(declaration.classpath)
        cls = _class_of_level(cls, declaration.level)
        component = cls(obj, robot)
        realism = declaration.options.get("realism")
        if isinstance(realism, RealismModel):
            component.realism = Realism(component, realism)
        return component
    except MorseError as error:
        raise LoadError(f"{_where(declaration)}: {error}") from None
    except Exception as error:
        raise LoadError(f"{_where(declaration)} could not be made: {describe(error)}") from error


def _class_of_level(cls: type[Any], level: str | None) -> type[Any]:
    declared = levels(cls)
    chosen = declared.get(level) if level is not None else next((v for v in declared.values() if v.default), None)
    return load_class(chosen.classpath) if chosen is not None and chosen.classpath else cls


def _connect(context: Context, loaded: Loaded) -> None:
    everything: dict[str, Object] = {**context.robots, **context.components}
    for declaration in context.scene.components:
        component = everything.get(declaration.name)
        if component is None:
            continue
        for modifier in declaration.modifiers:
            _add_modifier(component, declaration, modifier, loaded)
        for stream in declaration.streams:
            manager = context.stream_managers.get(stream.manager)
            if manager is None:
                manager = context.stream_managers[stream.manager] = make_stream_manager(context, stream.manager)
            try:
                manager.register_component(component, stream)
            except MorseError as error:
                raise LoadError(f"{_where(declaration)}: {error}") from None
        for name in declaration.managers:
            add_request_manager(context, name)
            context.services.register_request_manager_mapping(declaration.name, name)
        context.services.register_object(declaration.name, component)
        for overlay in declaration.overlays:
            add_request_manager(context, overlay.manager)
            instance = load_class(overlay.classpath)(component, **overlay.options)
            context.overlays[instance.name()] = instance
            context.services.register_request_manager_mapping(instance.name(), overlay.manager)
            context.services.register_object(instance.name(), instance)


def _add_modifier(component: Object, declaration: ComponentDeclaration, modifier: Any, loaded: Loaded) -> None:
    try:
        instance = load_class(modifier.classpath)(component, dict(modifier.options))
        instance.initialize()
    except MorseError as error:
        raise LoadError(f"modifier of {_where(declaration)}: {error}") from None
    except Exception as error:
        raise LoadError(f"modifier {modifier.classpath} of {_where(declaration)}: {describe(error)}") from error
    target = component.output_modifiers if declaration.kind == "sensor" else component.input_modifiers
    target.append(instance)
    loaded.modifier_objects.append(instance)
    if modifier.classpath not in loaded.modifiers:
        loaded.modifiers.append(modifier.classpath)


def make_stream_manager(context: Context, classpath: str) -> Any:
    """Start the stream manager of a class path."""
    options = dict(context.scene.manager_options.get(classpath, {}))
    return load_class(classpath)(options, context)


def add_request_manager(context: Context, classpath: str) -> None:
    """Start the request manager of a class path, unless it runs already."""
    if classpath not in context.services.request_managers():
        context.services.add_request_manager(load_class(classpath)(context))
