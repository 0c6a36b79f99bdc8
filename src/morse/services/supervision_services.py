"""The pseudo component ``simulation``: inspect and change the simulation from outside."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, TypeVar

from morse.core.abstractobject import AbstractObject
from morse.core.exceptions import MorseRPCInvokationError, MorseRPCTypeError
from morse.core.limits import ColorNumbers, EulerAngles, Point, QuaternionNumbers
from morse.core.mathutils import Quaternion
from morse.core.object import Object
from morse.core.reports import log
from morse.core.reports.quoting import nearest, quoted, short
from morse.core.rows.marks import present_data
from morse.core.sensor import Sensor
from morse.core.services import service
from morse.core.values import JsonObject, Value

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from morse.core.context import Context
    from morse.core.world import Body
    from morse.scene import ComponentDeclaration, Image


_T = TypeVar("_T")


def details(context: Context) -> JsonObject:
    """Return the robots with their components, services and streams, and the environment."""
    declarations = {d.name: d for d in context.scene.components}
    return {
        "robots": [_robot(context, name, robot, declarations) for name, robot in context.robots.items()],
        "environment": context.scene.environment,
    }


def _robot(context: Context, name: str, robot: object, declarations: dict[str, ComponentDeclaration]) -> JsonObject:
    components = {
        component_name: _component(context, component, declarations[component_name])
        for component_name, component in context.components.items()
        if component.robot_parent is robot
    }
    description: JsonObject = {"name": name, "type": type(robot).__name__, "components": components}
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


#: largest energy of a lamp
_BRIGHTEST = 1e6


def set_color(context: Context, obj: Body, color: Sequence[float]) -> None:
    """Set the colour of the surfaces of an object and its parts; of its light, if it is a lamp.

    Raises:
        ValueError: the colour is not valid, or the object has neither surface nor lamp.
    """
    check(obj, "color", color)
    red, green, blue, opacity = [*map(float, color), 1.0][:4]
    for part in _parts(obj, "color"):
        if part.node.mesh is None and part.node.light is not None:
            part.node.light = replace(part.node.light, color=(red, green, blue))
        else:
            part.node.color = (red, green, blue, opacity)
        context.world.appearance_changed(part)


def set_texture(context: Context, obj: Body, image: Image) -> None:
    """Set the texture of the surfaces of an object and its parts.

    Raises:
        ValueError: the object has no surface.
    """
    check(obj, "texture", image)
    for part in _parts(obj, "texture"):
        part.node.image = image
        context.world.appearance_changed(part)


def set_light(context: Context, obj: Body, energy: float) -> None:
    """Set the energy of the lamps of an object and its parts.

    Raises:
        ValueError: the energy is not valid, or the object has no lamp.
    """
    check(obj, "light", energy)
    for part in _parts(obj, "light"):
        if part.node.light is not None:
            part.node.light = replace(part.node.light, energy=float(energy))
            context.world.appearance_changed(part)


def check(obj: Body, what: str, value: Value) -> None:
    """Raise the ValueError of `set_color` or `set_light`; ``what`` is ``color``, ``texture`` or ``light``."""
    if what == "color":
        if len(value) not in (3, 4) or not all(0.0 <= number <= 1.0 for number in value):
            raise ValueError(
                f"the colour of '{obj.name}' is {list(value)!r:.100}, expected red, green, blue from 0 to 1, and "
                "perhaps the opacity"
            )
    elif what == "light" and (not 0.0 <= value <= _BRIGHTEST or not math.isfinite(value)):
        raise ValueError(f"the energy of the lamp '{obj.name}' is {value!r:.100}, expected 0 to {_BRIGHTEST:g}")
    if not _parts(obj, what):
        expected = {"color": "neither a surface nor a lamp", "texture": "no surface"}.get(what, "no lamp")
        raise ValueError(f"'{obj.name}' has {expected}: it has no {what} to set")


def _parts(obj: Body, what: str) -> list[Body]:
    everything = [obj, *obj.childrenRecursive]
    lamps = [part for part in everything if part.node.light is not None]
    surfaces = [part for part in everything if part.node.mesh is not None]
    if what == "texture":
        return surfaces
    return (surfaces or lamps) if what == "color" else lamps


#: names that are listed in the error message about a wrong name
_PARTS = ("core.", "middleware.", "simulation.", "physics.", "viewer")


class Supervision(AbstractObject):
    """Services for robots, components, objects and the life cycle of the simulation.

    Args:
        stop: function that ends the simulation.
        measure: function that lets sensors measure, see `measure`.
        picture: reads the picture of a texture.
    """

    def __init__(
        self,
        context: Context,
        stop: Callable[[], None],
        measure: Callable[[list[str] | None, bool], None],
        picture: Callable[[str], Image],
    ) -> None:
        super().__init__()
        self.context, self._picture = context, picture
        self._stop, self._measure = stop, measure

    def name(self) -> str:
        """``simulation``."""
        return "simulation"

    @service(changes=False)
    def list_robots(self) -> list[str]:
        """The names of the robots."""
        return list(self.context.robots)

    @service
    def reset_objects(self) -> str:
        """Move every object to its initial pose; components keep their data, so that an arm holds its last command."""
        self.context.world.reset()
        return "Objects restored to initial position"

    @service(changes=False)
    def quit(self) -> None:
        """End the simulation."""
        self._stop()

    @service(changes=False)
    def terminate(self) -> None:
        """End the simulation."""
        self._stop()

    @service
    def activate(self, component_name: str) -> None:
        """Activate a component."""
        self._component(component_name).active = True

    @service
    def deactivate(self, component_name: str) -> None:
        """Deactivate a component, until it is activated again."""
        self._component(component_name).active = False

    def _component(self, name: str) -> Object:
        everything = {**self.context.components, **self.context.robots}
        component = everything.get(name) if isinstance(name, str) else None
        if not isinstance(component, Object):
            raise MorseRPCInvokationError(f"Component {short(name)} unknown{nearest(str(name), list(everything))}")
        return component

    @service
    def measure(self, sensors: list[str] | None = None, again: bool = True) -> None:
        """Let sensors measure now, between two ticks, in addition to the measurements at their rates.

        Args:
            sensors: full names; all if not given.
            again: whether those measure, too, that have measured in the last tick.
        """
        self._measure(sensors, again)

    @service
    def suspend_dynamics(self) -> str:
        """Suspend the physics of every object, so that it stays in place."""
        for obj in self.context.world.objects():
            if obj.is_dynamic:
                obj.suspendDynamics()
        return "Physics is suspended"

    @service
    def restore_dynamics(self) -> str:
        """Resume the physics of every object."""
        for obj in self.context.world.objects():
            if obj.is_dynamic:
                obj.restoreDynamics()
        return "Physics is resumed"

    @service(changes=False)
    def details(self) -> JsonObject:
        """Return robots, components, services and streams, from which clients build their proxies."""
        return details(self.context)

    @service(changes=False)
    def set_log_level(self, component: str, level: str) -> None:
        """Set the log level of a part of the simulator.

        Args:
            component: a module or package, e.g. ``core.request_manager``, with or without ``morse.`` before it.
            level: ``debug``, ``info``, ``warning``, ``error`` or ``critical``.
        """
        if not isinstance(level, str) or level.upper() not in log.LEVELS:
            names = [name.lower() for name in log.LEVELS]
            raise MorseRPCTypeError(f"{quoted(level)} is not a log level{nearest(str(level), names)}")
        components = log.known_components()
        if component.removeprefix("morse.") not in components:
            hint = nearest(component, sorted(name for name in components if name.startswith(_PARTS)))
            raise MorseRPCTypeError(f"there is no logger {quoted(component)}{hint}")
        log.set_level(component, level)

    @service(changes=False)
    def get_scene_objects(self) -> JsonObject:
        """Return the tree of objects: name to children, position (m) and quaternion (x, y, z, w)."""
        return self._tree(obj for obj in self.context.world.objects() if obj.parent is None)

    def _tree(self, objects: Iterable[Body]) -> JsonObject:
        tree: JsonObject = {}
        for obj in objects:
            w, x, y, z = obj.worldOrientation.to_quaternion()
            tree[obj.name] = [self._tree(obj.children), list(obj.worldPosition), [x, y, z, w]]
        return tree

    @service
    def set_object_visibility(self, object_name: str, visible: bool, do_children: bool) -> bool:
        """Show or hide an object, optionally with all its children; return the new state."""
        self._object(object_name).setVisible(bool(visible), bool(do_children))
        return bool(visible)

    @service
    def set_object_dynamics(self, object_name: str, state: bool) -> bool:
        """Enable or suspend the physics of an object; return the new state."""
        obj = self._object(object_name)
        if state:
            obj.restoreDynamics()
        else:
            obj.suspendDynamics()
        return bool(state)

    @service
    def set_object_position(self, object_name: str, position: Point, orientation: EulerAngles | None = None) -> None:
        """Move an object to a pose, at rest.

        Args:
            position: x, y, z in the world, m.
            orientation: roll, pitch, yaw, rad; unchanged if not given.
        """
        obj = self._object(object_name)
        if orientation is not None:
            obj.worldOrientation = [float(angle) for angle in orientation]
        obj.worldPosition = [float(coordinate) for coordinate in position]
        obj.halt()

    @service
    def set_object_mass(self, object_name: str, mass: float) -> None:
        """Set the mass of an object that moves freely, until the next reset; its inertia changes in proportion.

        Args:
            mass: kg.
        """
        self._vary(self.context.world.set_mass, object_name, float(mass))

    @service
    def set_object_friction(self, object_name: str, friction: float) -> None:
        """Set the friction of all shapes of an object, until the next reset.

        Args:
            friction: coefficient of sliding friction.
        """
        self._vary(self.context.world.set_friction, object_name, float(friction))

    @service
    def set_object_color(self, object_name: str, color: ColorNumbers) -> None:
        """Set the colour of all surfaces of an object with its parts, or of the light of a lamp, until the next reset.

        Args:
            color: red, green, blue, linear, 0 to 1; a fourth number is the opacity of a surface.
        """
        self._vary(partial(set_color, self.context), object_name, color)

    @service
    def set_object_texture(self, object_name: str, picture: str) -> None:
        """Set the texture of all surfaces of an object with its parts, until the next reset.

        Args:
            picture: path of a PNG or JPEG file in a folder of models or in the folder of the simulation. On a mesh
                without texture coordinates it covers each side of the bounding box once.
        """
        self._vary(partial(set_texture, self.context), object_name, self._picture(picture))

    @service
    def set_object_light(self, object_name: str, energy: float) -> None:
        """Set the brightness of a lamp, or of all lamps of an object, until the next reset.

        Args:
            energy: relative to a normal lamp.
        """
        self._vary(partial(set_light, self.context), object_name, energy)

    def _vary(self, change: Callable[[Body, _T], None], name: str, value: _T) -> None:
        try:
            change(self._object(name), value)
        except ValueError as error:
            raise MorseRPCTypeError(str(error)) from None

    @service
    def set_object_pose(self, object_name: str, position: Point, quaternion: QuaternionNumbers) -> None:
        """Move an object to a pose, at rest.

        Args:
            position: x, y, z in the world, m.
            quaternion: w, x, y, z; of any length but zero.
        """
        if not any(quaternion):
            raise MorseRPCTypeError("the quaternion 0, 0, 0, 0 is not an orientation; 1, 0, 0, 0 is no rotation")
        obj = self._object(object_name)
        components = self.context.components
        parts = [components.get(part.name) for part in (obj, *obj.childrenRecursive)]
        sensors = [part for part in parts if isinstance(part, Sensor) and type(part).placed is not Sensor.placed]
        for sensor in sensors:
            present_data(sensor)  # those that measure when they are read measure where the robot still is
        obj.worldOrientation = Quaternion([float(number) for number in quaternion])
        obj.worldPosition = [float(coordinate) for coordinate in position]
        obj.halt()
        for sensor in sensors:
            sensor.placed()

    def _object(self, name: str) -> Body:
        objects = self.context.world.objects_by_name
        try:
            return objects[name]
        except (KeyError, TypeError):
            raise MorseRPCInvokationError(f"Object {short(name)} unknown{nearest(str(name), list(objects))}") from None
