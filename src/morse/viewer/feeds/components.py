"""What pages show of components: their declarations, activity, data and properties."""

from __future__ import annotations

import inspect
import reprlib
import time
from functools import partial
from typing import TYPE_CHECKING

from morse.builder.creator import SensorCreator, noisy_fields
from morse.builder.names.catalog import modifier_classes
from morse.core.actuator import Actuator
from morse.core.classes.classpath import load_class
from morse.core.declarations import fields_of_component, levels, properties
from morse.core.rows.marks import known_data, present_data
from morse.core.services import signature_of
from morse.middleware.registry import installed
from morse.scene.component import RealismModel
from morse.viewer.description import (
    ArgumentDescription,
    ComponentDescription,
    FieldDescription,
    PropertyDescription,
    ServiceDescription,
    SettingDescription,
)
from morse.viewer.view_messages import (
    Activity,
    Capturing,
    ComponentSettings,
    DebugProperties,
    DebugProperty,
    PropertyValue,
    Values,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence

    from morse.core.abstractobject import AbstractObject
    from morse.core.context import Context
    from morse.core.declarations import Option
    from morse.core.interfaces import Component, Offering
    from morse.core.object import Object
    from morse.core.sensor import Sensor
    from morse.core.values import JsonObject, Value
    from morse.physics.objects.gameobject import GameObject
    from morse.simulation.simulation import Simulation
    from morse.simulation.ticks.profile import Profile
    from morse.viewer.server import ViewServer


# Describes the components of a simulation for the live view, from their declarations.


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
    cls, data = type(component), known_data(component)
    return ComponentDescription(
        name=component.name(),
        kind=kind,
        robot=robot,
        title=getattr(component, "_name", cls.__name__),
        doc=getattr(component, "_short_desc", "") or _first_line(component),
        frequency=component.frequency,
        level=component.level or "",
        active=component.active,
        pictured=hasattr(component, "shown") or "image" in data,
        data=[
            FieldDescription(name, field.type, field.doc, field.unit, *_bounds(field), field.reached)
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


#: methods that set up a sensor, whose arguments are read from their signatures, and the units of these
_REALISM = ("noise", "delay", "phase")
_UNITS = {"seconds": "s"}


def settings_of(
    simulation: Simulation, name: str, own: Iterable[tuple[str, Mapping[str, object]]]
) -> ComponentSettings | None:
    """How a sensor or an actuator can be set up; None if there is none of that name.

    Args:
        own: methods and arguments of what pages have called.
    """
    declaration = next((d for d in simulation.scene.components if d.name == name), None)
    component = simulation.context.components.get(name)
    if declaration is None or component is None or declaration.kind not in ("sensor", "actuator"):
        return None
    cls = load_class(declaration.classpath)
    rate = PropertyDescription("", "float", "", component.frequency, unit="Hz", low=0.0)
    settings = [SettingDescription("frequency", "", "how often it measures or acts", [rate])]
    if choices := levels(cls):
        doc = "; ".join(f"{level}: {entry.doc}" for level, entry in choices.items())
        level = PropertyDescription("", "str", doc, component.level, [*choices])
        settings.append(SettingDescription("level", "", "level of abstraction", [level]))
    if declaration.kind == "sensor":
        realism = declaration.options.get("realism")
        settings += [
            _realism(method, realism if isinstance(realism, RealismModel) else RealismModel(), noisy_fields(cls))
            for method in _REALISM
        ]
    names = {base.__name__ for base in cls.__mro__}
    modifiers = {
        modifier: next(path for base, path in classes.items() if base in names)
        for modifier, classes in sorted(modifier_classes().items())
        if not names.isdisjoint(classes)
    }
    settings += [described_modifier(modifier, path) for modifier, path in modifiers.items()]
    direction = "OUT" if declaration.kind == "sensor" else "IN"
    middlewares = [one for one in installed().values() if one.stream_of(cls, direction) is not None]
    settings += [
        SettingDescription("add_stream", one.name, one.missing or one.purpose, _options(one.stream_options or {}))
        for one in middlewares
    ]
    mine = [(method, str(values.get("", "")) if method in ("alter", "add_stream") else "") for method, values in own]
    names_of = {path: modifier for modifier, path in modifiers.items()}
    managers = {one.stream_manager: one.name for one in middlewares}
    scripted = [("alter", names_of.get(one.classpath, one.classpath)) for one in declaration.modifiers]
    scripted += [("add_stream", managers.get(one.manager, one.manager)) for one in declaration.streams]
    return ComponentSettings(name, settings, mine, [one for one in scripted if one not in mine])


def _realism(method: str, present: RealismModel, fields: Sequence[str]) -> SettingDescription:
    """A method of the builder that sets ``present``; ``fields`` are those that can have noise."""
    function = getattr(SensorCreator, method)
    value = getattr(present, method)
    arguments = [
        PropertyDescription(
            p.name,
            "str" if p.name == "field" else "float",
            "a data field; empty for all" if p.name == "field" else "",
            value if p.default is p.empty else "" if p.default is None else p.default,
            ["", *fields] if p.name == "field" else None,
            unit=_UNITS.get(p.name, ""),
        )
        for p in list(inspect.signature(function).parameters.values())[1:]
    ]
    return SettingDescription(method, "", (inspect.getdoc(function) or "").partition("\n")[0], arguments)


def described_modifier(name: str, classpath: str) -> SettingDescription:
    """A modifier with its options."""
    cls = load_class(classpath)
    return SettingDescription("alter", name, inspect.getdoc(cls) or "", _options(getattr(cls, "options", {})))


def _options(options: Mapping[str, Option]) -> list[PropertyDescription]:
    return [
        PropertyDescription(
            name,
            " or ".join(one.__name__ for one in (option.type if isinstance(option.type, tuple) else (option.type,))),
            option.doc,
            option.default,
            list(option.choices) or None,
            option.unit,
            *_bounds(option),
        )
        for name, option in options.items()
    ]


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


# Sends the activity of components, and their properties after every change.

#: number of properties that are sent at once, to all pages: one that watches thousands of them must not make the others
#: wait
_MOST_TOLD = 500


class StatesFeed:
    """Compares the states of components with the states that were last sent."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._components: list[tuple[str, Component]] | None = None
        self._cameras: list[Sensor] = []
        self._active: list[bool] = []
        self._values: dict[str, JsonObject] = {}
        self._capturing: bool | None = None

    def restarted(self) -> None:
        """Forget the states, because the components are described again."""
        self.rearranged()
        self._active.clear()
        self._values.clear()

    def rearranged(self) -> None:
        """Components may have been replaced."""
        self._components = None

    def _present(self) -> list[tuple[str, Component]]:
        if self._components is None:
            self._components = [*self._context.robots.items(), *self._context.components.items()]
            self._cameras = cameras_of(self._context)
        return self._components

    def update(self) -> None:
        """Send the changes since the last call."""
        components = self._present()
        active = [component.active for _, component in components]
        if active != self._active:
            # a component is active unless a service has deactivated it
            before = self._active if len(self._active) == len(active) else [True] * len(active)
            for (name, _), now, earlier in zip(components, active, before, strict=True):
                if now is not earlier:
                    self._server.send(Activity(name, now))
            self._active = active
        left = _MOST_TOLD
        for name in self._server.wishes.values:
            component = self._context.components.get(name) or self._context.robots.get(name)
            if component is not None and left > 0:
                left -= self._tell_properties(name, component)
        self.tell_capturing()

    def _tell_properties(self, name: str, component: Component) -> int:
        """Send the changed properties of a component, and return their number."""
        values, count = self._values.setdefault(name, {}), 0
        for python_name, prop in properties(type(component)).items():
            value = getattr(component, python_name)
            if prop.name not in values or values[prop.name] != value:
                values[prop.name] = value
                self._server.send(PropertyValue(name, prop.name, value))
                count += 1
        return count

    def tell_capturing(self) -> None:
        """Send whether cameras capture images."""
        self._present()
        cameras = self._cameras
        capturing = any(camera.capturing for camera in cameras) if cameras else None
        if capturing is not None and capturing is not self._capturing:
            self._server.send(Capturing(capturing))
        self._capturing = capturing


def cameras_of(context: Context) -> list[Sensor]:
    """The components that capture images, active or paused."""
    from morse.core.sensor import Sensor

    sensors = (component for component in context.components.values() if isinstance(component, Sensor))
    return [sensor for sensor in sensors if sensor.capturing is not None]


# Sends the data of components to the pages that show them.

#: maximum number of displayed values of an array: a scan, but not an image
_MOST_ITEMS = 4096


class ValuesFeed:
    """Sends the data of components."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server

    def update(self) -> None:
        """Send the data that pages show."""
        now = self._context.clock.time
        for name in sorted(self._server.wishes.values):
            component = self._context.component(name)
            if component is not None:
                data = self._context.guard.run(partial(_data_of, component), _not_shown)
                self._server.send(Values(name, now, data or {}, "The data cannot be read." if data is None else ""))


def _data_of(component: Object) -> JsonObject:
    return {str(field): shown(value) for field, value in present_data(component).items()}


def _not_shown(_error: BaseException) -> None:
    """A component that fails is named when it acts."""


def shown(value: Value) -> Value:
    """Return the value, or a short description if the value is too large to be shown."""
    size = getattr(value, "size", None)
    if isinstance(size, int) and size > _MOST_ITEMS:
        return f"{tuple(value.shape)} of {value.dtype}"
    if isinstance(value, (bytes, bytearray, memoryview)):
        return f"{len(value)} bytes"
    if isinstance(value, (str, list, tuple, dict)) and len(value) > _MOST_ITEMS:
        return f"{len(value)} {'characters' if isinstance(value, str) else 'values'}"
    return value


# Shows pages the properties selected by ``env.show_debug_properties()``, and the costs of profiled sensors.

#: maximum number of lines; the number of the others is shown instead
_MOST_LINES = 100
#: maximum number of characters of a string
_LENGTH = 200
#: wall-clock seconds between two updates of properties, and of costs
_LOOKS, _COSTS = 0.2, 1.0


class ViewDebug:
    """Sends the marked properties, and properties that were set while the simulation runs."""

    def __init__(self, simulation: Simulation, server: ViewServer) -> None:
        self._world = simulation.world
        self._profile: Profile | None = simulation.sensor_profile
        self._server = server
        self._is_on = simulation.scene.settings.view.show_debug_properties
        self._profile_names = [d.name for d in simulation.scene.components if d.profile]
        self._times: dict[str, float] = {}
        self._shares: list[DebugProperty] = []
        self._last_look = self._last_measurement = 0.0
        self._last_message: DebugProperties | None = None

    def update(self) -> None:
        """Send the list if it has changed since the last call."""
        now = time.monotonic()
        if not (self._is_on or self._profile_names) or now - self._last_look < _LOOKS:
            return
        self._last_look = now
        if now - self._last_measurement >= _COSTS:
            self._shares = list(self._costs(now - self._last_measurement)) if self._last_measurement else []
            self._last_measurement = now
        lines = [*self._shares]
        if self._is_on:
            lines += [line for obj in self._world.objects_by_name.values() for line in _shown(obj)]
        message = DebugProperties(lines[:_MOST_LINES], max(0, len(lines) - _MOST_LINES))
        if message != self._last_message:
            self._last_message = message
            self._server.send(message)

    def _costs(self, seconds: float) -> Iterator[DebugProperty]:
        """The share of one processor that each profiled sensor used in that time."""
        if self._profile is None:
            return
        for name in self._profile_names:
            cost = self._profile.components.get(name)
            total = 0.0 if cost is None else cost.total
            share = (total - self._times.get(name, 0.0)) / seconds
            self._times[name] = total
            yield DebugProperty(name, "profile", f"{100.0 * share:.1f} %")


def _shown(obj: GameObject) -> Iterator[DebugProperty]:
    own = obj.node.properties
    for name, value in obj.properties.items():
        if name in obj.node.debug or name not in own or own[name] is not value:
            # values of users may be of any type and size, and may be impossible to format
            text = value if isinstance(value, str) else reprlib.repr(value)
            yield DebugProperty(obj.name, str(name), text[:_LENGTH])
