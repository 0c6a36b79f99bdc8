"""Builder classes that are derived from the declarations of components."""

from __future__ import annotations

import inspect
import logging
from functools import partial
from typing import TYPE_CHECKING

from morse.builder.components import actuators_with_parts, armatures
from morse.builder.components.actuators_with_parts import Joystick
from morse.builder.components.robots import DRIVES, DeclaredRobot, Human, Morsy, robot_defaults
from morse.builder.components.sensors import (
    VLP16_180,
    CameraCreator,
    CompoundSensor,
    ContactSensor,
    Kinect,
    LaserSensorWithArc,
)
from morse.builder.creator import ActuatorCreator, SensorCreator
from morse.builder.names import catalog
from morse.core.classes.builder_defaults import builder_defaults
from morse.core.classes.plugins import PluginError, attempt, entry_points
from morse.core.exceptions import MorseBuilderNoComponentError
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping
    from importlib.metadata import EntryPoint

    from morse.builder.components.component import Component
    from morse.builder.names.catalog import Entry

logger = logging.getLogger(__name__)

_CREATORS: dict[str, type[Component]] = {"sensors": SensorCreator, "actuators": ActuatorCreator}

#: the base classes of components, by name; they are imported on demand
_BASES = {
    "morse.core.sensor.Sensor": "sensors",
    "morse.core.actuator.Actuator": "actuators",
    "morse.core.robot.Robot": "robots",
}

#: builder classes with additional methods or their own body, by component class; they hold for its subclasses, too
_WITH_METHODS: Mapping[str, type[Component]] = {
    "morse.sensors.bumper.Bumper": ContactSensor,
    "morse.sensors.collision.Collision": ContactSensor,
    "morse.sensors.laserscanner.LaserScanner": LaserSensorWithArc,
    "morse.sensors.camera.Camera": CameraCreator,
}

#: builder classes that are written by hand; products are named after the component class
_BY_HAND: Mapping[str, type[Component]] = {
    "morse.actuators.armature.Armature": armatures.Armature,
    "morse.actuators.armature.Armature KukaLWR": armatures.KukaLWR,
    "morse.actuators.joystick.Joystick": Joystick,
    "morse.actuators.led_array.LedArray": actuators_with_parts.LedArray,
    "morse.actuators.light.Light": actuators_with_parts.Light,
    "morse.actuators.ptu.PTU": actuators_with_parts.PTU,
    "morse.actuators.sound.Sound": actuators_with_parts.Sound,
    "morse.actuators.v_omega_diff_drive.MotionVWDiff": actuators_with_parts.MotionVWDiff,
    "morse.robots.human.Human": Human,
    "morse.robots.morsy.Morsy": Morsy,
    "morse.sensors.compound.CompoundSensor": CompoundSensor,
    "morse.sensors.kinect.Kinect": Kinect,
    "morse.sensors.vlp16.VLP16_180": VLP16_180,
}


def derived_classes(package: str, module: str) -> dict[str, type[Component]]:
    """Return a builder class for each component of a package.

    Args:
        package: e.g. ``morse.sensors``; its last part is the kind of component.
        module: module of the new classes.
    """
    kind = package.rpartition(".")[2]
    return {
        name: derived_class(entry, kind, module)
        for name, entry in catalog.components(package).items()
        # a robot class that declares no defaults is a base class of other robots
        if kind != "robots" or entry.defaults is not None
    }


def installed_classes(module: str, besides: Collection[EntryPoint] = ()) -> dict[str, type[Component]]:
    """A builder class for each component of the packages that the entry points ``morse.components`` name.

    Args:
        module: module of the new classes.
        besides: entry points that are left out.
    """
    classes: dict[str, type[Component]] = {}
    # a class of a user's package takes the place of one of the same name in a plug-in of MORSE
    for point in sorted(entry_points("morse.components"), key=lambda point: not point.value.startswith("morse.")):
        if point in besides:
            continue
        try:
            for kind in _CREATORS | {"robots": DeclaredRobot}:
                classes |= attempt(partial(derived_classes, f"{point.value}.{kind}", module))
        except PluginError as error:
            # an error in a third-party package must not prevent the scene from being built
            logger.warning(
                "the components of the installed package '%s' are left out: %s", point.value, error, extra=OF_MACHINE
            )
    return classes


def derived_class(entry: Entry, kind: str, module: str) -> type[Component]:
    """The builder class of a component.

    Args:
        entry: declarations of the component.
        kind: ``sensors``, ``actuators`` or ``robots``.
        module: module of the new class.
    """
    by_hand = _BY_HAND.get(_with_product(entry.classpath, entry.product))
    if by_hand is not None:
        return by_hand
    bases: tuple[type[Component], ...]
    if kind == "robots":
        if by_package := (entry.defaults or {}).get("builder"):
            return catalog.load_class(by_package)
        bases = (DeclaredRobot, DRIVES[(entry.defaults or {}).get("drive", "ground")])
    else:
        bases = (next(_with_methods(entry.classpath), _CREATORS[kind]),)
    body: dict[str, object] = {"_classpath": entry.classpath, "__doc__": entry.doc, "__module__": module}
    if kind != "robots":
        body["_product"] = entry.product
    return type(entry.name, bases, body)


def _with_methods(classpath: str) -> Iterator[type[Component]]:
    """The builder classes of a component class and of its base classes, as far as their files name these."""
    if classpath in _WITH_METHODS:
        yield _WITH_METHODS[classpath]
    package = classpath.rpartition(".")[0].rpartition(".")[0]
    if package.endswith((".sensors", ".actuators")):
        for base in catalog.base_classes(package, classpath):
            yield from _with_methods(base)


def builder_class(cls: type, product: str | None = None, module: str | None = None) -> type[Component]:
    """The builder class of a loaded component class.

    Args:
        cls: the component class.
        product: name of one of its products; None for the class itself.
        module: module of the new class; None for the module of the component.

    Raises:
        MorseBuilderNoComponentError: it is neither a sensor, an actuator nor a robot.
    """
    paths = [f"{base.__module__}.{base.__qualname__}" for base in cls.__mro__]
    kind = next((_BASES[path] for path in paths if path in _BASES), None)
    if kind is None:
        raise MorseBuilderNoComponentError(
            f"{paths[0]} is not a component: its base class has to be Sensor, Actuator or Robot"
        )
    by_hand = _BY_HAND.get(_with_product(paths[0], product))
    if by_hand is not None:
        return by_hand
    defaults = cls.__dict__.get("_builder")
    name = product or getattr(defaults, "name", None) or cls.__name__
    doc = builder_defaults(cls, product).doc or cls.__dict__.get("_short_desc") or inspect.getdoc(cls) or ""
    bases: tuple[type[Component], ...]
    if kind == "robots":
        if by_package := robot_defaults(cls).builder:
            return catalog.load_class(by_package)
        bases = (DeclaredRobot, DRIVES[robot_defaults(cls).drive])
    else:
        bases = (next((_WITH_METHODS[path] for path in paths if path in _WITH_METHODS), _CREATORS[kind]),)
    body = {"_classpath": paths[0], "_product": product, "__doc__": doc, "__module__": module or cls.__module__}
    return type(name, bases, body)


def _with_product(classpath: str, product: str | None) -> str:
    return classpath if product is None else f"{classpath} {product}"
