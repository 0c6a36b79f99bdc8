"""Builder classes that are derived from the declarations of components."""

from __future__ import annotations

import inspect
import logging
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from morse.assets import search
from morse.builder import workspace
from morse.builder.blender.materials import material_slots
from morse.builder.components import armatures, furnished
from morse.builder.components.armatures import Armature
from morse.builder.components.cameras import VLP16_180, CameraCreator, Kinect
from morse.builder.components.compound import CompoundSensor
from morse.builder.components.lasers import LaserSensorWithArc
from morse.builder.components.robot import GroundRobot, Robot, WheeledRobot
from morse.builder.creator import ActuatorCreator, SensorCreator
from morse.builder.errors import checks
from morse.builder.names import catalog
from morse.builder.names.classes import load_class
from morse.core.classes.builder_defaults import RobotDefaults, builder_defaults
from morse.core.classes.plugins import entry_points
from morse.core.exceptions import MorseBuilderNoComponentError
from morse.middleware import registry
from morse.scene import NodeKind, PhysicsType
from morse.system import OF_MACHINE

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from morse.builder.components.component import Component
    from morse.builder.names.catalog import Entry
    from morse.core.classes.builder_defaults import Visual
    from morse.scene import Material

#: bones with a target for inverse kinematics
_TARGETS = ("head", "wrist_L", "wrist_R", "foot_L", "foot_R")


class _Skeleton(Armature):
    _classpath = "morse.actuators.walking_skeleton.WalkingSkeleton"


class _JointStates(SensorCreator):
    _classpath = "morse.sensors.armature_pose.ArmaturePose"


class Human(GroundRobot):
    """A person; the component class is `morse.robots.human.Human`.

    Args:
        filename: name of the model in ``robots``.
        name: its name, if it differs from the name of the variable that refers to it.

    Attributes:
        skeleton: the `Armature` of the person, with targets for the head, the wrists and the feet.
        joint_states: the `ArmaturePose` of the skeleton.
    """

    _classpath = "morse.robots.human.Human"

    def __init__(self, filename: str = "human_rig", name: str | None = None) -> None:
        super().__init__(filename, name)
        self.skeleton = _Skeleton(armature_name="HumanSkeleton")
        self.append(self.skeleton)
        self.skeleton.create_ik_targets(_TARGETS)
        self.joint_states = _JointStates()
        self.skeleton.append(self.joint_states)
        self.skeleton.name, self.joint_states.name = "skeleton", "joint_states"

    def add_interface(self, interface: str, **kwargs: object) -> None:
        """Connect the skeleton and its joint values to a middleware.

        Args:
            interface: name of a middleware.
            **kwargs: options of the streams.

        Raises:
            MorseMiddlewareError: unknown middleware.
        """
        registry.middleware(interface)
        self.skeleton.add_interface(interface, **kwargs)
        self.joint_states.add_interface(interface, **kwargs)


#: ``RobotDefaults.drive`` to the builder class that implements it
DRIVES: Mapping[str, type[Robot]] = {"free": Robot, "ground": GroundRobot, "wheels": WheeledRobot}


def robot_defaults(cls: type) -> RobotDefaults:
    """Return the declaration of a robot class; the default is a ground robot with the model of the same name."""
    defaults = getattr(cls, "_builder", None)
    if isinstance(defaults, RobotDefaults):
        return defaults
    project, _, file = cls.__module__.rpartition(".robots.")
    own = f"{project}/robots/{file}.blend"
    try:
        search.find(own, "robots")
    except FileNotFoundError:
        own = ""
    wheeled = any(base.__name__ == "PhysicsDifferentialRobot" for base in cls.__mro__)
    return RobotDefaults(own or None, drive="wheels" if wheeled else "ground")


class DeclaredRobot(Robot):
    """A robot whose model and properties come from the `RobotDefaults` of its component class.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
    """

    def __init__(self, name: str | None = None) -> None:
        defaults = robot_defaults(load_class(self._classpath))
        super().__init__(defaults.model or "", name)
        if defaults.rigid_body:
            self.set_rigid_body()
        if not defaults.collides:
            self.set_no_collision()
        self.properties(**defaults.properties)


_MORSY_COLORS = ((0.9, 0.35, 0.1), (0.1, 0.45, 0.8), (0.2, 0.6, 0.25), (0.75, 0.1, 0.3), (0.45, 0.25, 0.7))


class Morsy(DeclaredRobot, GroundRobot):
    """The mascot of MORSE, a small rigid robot to drive around."""

    _classpath = "morse.robots.morsy.Morsy"

    def __init__(self, name: str | None = None) -> None:
        super().__init__(name)
        self.set_collision_bounds()
        self.scene_node.body.radius = 0.08

    def set_color(
        self, color: Iterable[float] | float | None = None, g: float | None = None, b: float | None = None
    ) -> None:
        """Set the colour of its body.

        Args:
            color: red, green and blue, 0..1, as one sequence; None for a colour that depends on the number of such
                robots.
            g: green, if ``color`` is only red.
            b: blue, if ``color`` is only red.
        """
        if color is None:
            row = [robot for robot in workspace.current().components if isinstance(robot, Morsy)]
            color = _MORSY_COLORS[row.index(self) % len(_MORSY_COLORS)]
        elif g is not None or b is not None:
            color = (color, g or 0.0, b or 0.0)  # type: ignore[assignment]
        rgb = checks.color(color, "Morsy.set_color(color)")
        copies: dict[Material | None, Material] = {}
        for node in self.own_nodes():
            slots = material_slots(node)
            for material in slots:
                if material is not None and "body" in material.name.lower():
                    copies.setdefault(material, replace(material, color=(*rgb, material.color[3])))
            node.materials[:] = [copies.get(material, material) for material in slots]


class ContactSensor(SensorCreator):
    """A sensor that detects contacts with its own body, which does not collide.

    ``scale`` is half the size of that body along each axis, m.
    """

    def _add_marker(self, visual: Visual) -> None:
        node = self.scene_node
        node.kind = NodeKind.MESH
        node.mesh, node.materials = self._marker(visual)
        node.scale[:] = visual.scale
        node.body.type = PhysicsType.SENSOR


class Joystick(ActuatorCreator):
    """A gamepad at the live view; its component class is `morse.actuators.joystick.Joystick`."""

    _classpath = "morse.actuators.joystick.Joystick"

    def __init__(self, name: str | None = None, index: int = 0) -> None:
        """Create a joystick.

        Args:
            index: pair of axes of the gamepad: 0 for the first stick.
        """
        super().__init__(name)
        self.properties(Index=checks.integer(index, "Joystick(index)", minimum=0))


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
    "morse.actuators.led_array.LedArray": furnished.LedArray,
    "morse.actuators.light.Light": furnished.Light,
    "morse.actuators.ptu.PTU": furnished.PTU,
    "morse.actuators.sound.Sound": furnished.Sound,
    "morse.actuators.v_omega_diff_drive.MotionVWDiff": furnished.MotionVWDiff,
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


def installed_classes(module: str) -> dict[str, type[Component]]:
    """A builder class for each component of the packages that the entry points ``morse.components`` name.

    Args:
        module: module of the new classes.
    """
    classes: dict[str, type[Component]] = {}
    for point in entry_points("morse.components"):
        try:
            for kind in _CREATORS | {"robots": DeclaredRobot}:
                classes |= derived_classes(f"{point.value}.{kind}", module)
        except Exception as error:
            # an error in a third-party package must not prevent the scene from being built
            logger.warning(
                "the components of the installed package '%s' are left out: %r", point.value, error, extra=OF_MACHINE
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
        bases = (DeclaredRobot, DRIVES[(entry.defaults or {}).get("drive", "ground")])
    else:
        bases = (next(_with_methods(entry.classpath), _CREATORS[kind]),)
    body: dict[str, Any] = {"_classpath": entry.classpath, "__doc__": entry.doc, "__module__": module}
    if kind != "robots":
        body["_product"] = entry.product
    return type(entry.name, bases, body)


def _with_methods(classpath: str) -> Iterator[type[Component]]:
    """The builder classes of a component class and of its base classes, as far as their files name these."""
    if classpath in _WITH_METHODS:
        yield _WITH_METHODS[classpath]
    package = classpath.rpartition(".")[0].rpartition(".")[0]
    if package.endswith((".sensors", ".actuators")):
        for base in catalog.base_classes(package).get(classpath, ()):
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
        bases = (DeclaredRobot, DRIVES[robot_defaults(cls).drive])
    else:
        bases = (next((_WITH_METHODS[path] for path in paths if path in _WITH_METHODS), _CREATORS[kind]),)
    body = {"_classpath": paths[0], "_product": product, "__doc__": doc, "__module__": module or cls.__module__}
    return type(name, bases, body)


def _with_product(classpath: str, product: str | None) -> str:
    return classpath if product is None else f"{classpath} {product}"
