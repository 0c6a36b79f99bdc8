"""Robots with bodies or methods of their own, and those that are created from the declarations of their class."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets import search
from morse.builder import workspace
from morse.builder.components.armatures import Armature
from morse.builder.components.robot import GroundRobot, Robot, WheeledRobot
from morse.builder.components.sensors import CompoundSensor, LaserSensorWithArc
from morse.builder.creator import ActuatorCreator, SensorCreator
from morse.builder.errors import checks
from morse.builder.names.catalog import load_class
from morse.builder.objects import material_slots
from morse.core.classes.builder_defaults import RobotDefaults
from morse.middleware import registry

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from morse.builder.abstractcomponent import AbstractComponent
    from morse.core.values import Options
    from morse.scene import Material

#: bones with a target for inverse kinematics
_TARGETS = ("head", "wrist_L", "wrist_R", "foot_L", "foot_R")


class _Skeleton(Armature):
    _classpath = "morse.actuators.walking_skeleton.WalkingSkeleton"


class _JointStates(SensorCreator):
    _classpath = "morse.sensors.armature_pose.ArmaturePose"


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


#: attributes of the robot to the armatures of the model
_ARMATURES = {
    "torso": "torso_armature",
    "head": "head_armature",
    "l_arm": "l_arm_armature",
    "r_arm": "r_arm_armature",
}
#: place of the laser scanner of the base, m
_LASER = (0.275, 0.0, 0.303)
_JOINT_STATE = "morse.middleware.sockets.jointstate.PR2JointStatePublisher"


class _ArmaturePose(SensorCreator):
    _classpath = "morse.sensors.armature_pose.ArmaturePose"


class _MotionXYW(ActuatorCreator):
    _classpath = "morse.actuators.xy_omega.MotionXYW"


class _Odometry(SensorCreator):
    _classpath = "morse.sensors.odometry.Odometry"


class _Pose(SensorCreator):
    _classpath = "morse.sensors.pose.Pose"


class _Keyboard(ActuatorCreator):
    _classpath = "morse.actuators.keyboard.Keyboard"


class _Hokuyo(LaserSensorWithArc):
    _product = "Hokuyo"


class BarePR2(GroundRobot):
    """A PR2 with its joints: torso, head and two arms.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.

    Attributes:
        torso, head, l_arm, r_arm: the armatures.
        torso_pose, head_pose, l_arm_pose, r_arm_pose: their joint values, with the name ``pose`` below the armature.
        joint_state: the joint values of all armatures.
    """

    _classpath = "morse.robots.pr2.PR2"

    def __init__(self, name: str | None = None) -> None:
        super().__init__("pr2", name)
        self._equipment: list[AbstractComponent] = []
        poses = []
        for attribute, armature in _ARMATURES.items():
            limb, pose = Armature(armature_name=armature), _ArmaturePose("pose")
            self._equip(attribute, limb)
            limb.append(pose)
            setattr(self, f"{attribute}_pose", pose)
            self._equipment.append(pose)
            poses.append(pose)
        self.joint_state = CompoundSensor(poses)
        self.append(self.joint_state)
        self.joint_state.name = "joint_state"

    def _equip(self, attribute: str, component: AbstractComponent) -> None:
        setattr(self, attribute, component)
        self.append(component)
        component.name = attribute
        self._equipment.append(component)

    def add_interface(self, interface: str, **kwargs: object) -> None:
        """Connect all components to a middleware; on the socket, ``joint_state`` sends all joints in one flat object.

        Args:
            interface: name of a middleware.
            **kwargs: options of the streams.

        Raises:
            MorseMiddlewareError: unknown middleware.
        """
        middleware = registry.middleware(interface)
        for component in self._equipment:
            component.add_interface(interface, **kwargs)
        if middleware.name == "socket":
            self.joint_state.add_service(interface)
            self._stream(self.joint_state, interface, kwargs)
        else:
            self.joint_state.add_interface(interface, **_joint_options(middleware.name, kwargs))

    def _stream(self, part: AbstractComponent, middleware: str, options: Options) -> None:
        if part is self.joint_state and middleware == "socket":
            part.add_stream(middleware, _JOINT_STATE, **options)
        elif part is self.joint_state:
            part.add_stream(middleware, **_joint_options(middleware, options))
        else:
            super()._stream(part, middleware, options)


def _joint_options(middleware: str, options: Options) -> Options:
    """Return the options of the stream of all joints; in 1.4, its topic was not one of the robot."""
    return {"topic": "/joint_states", **options} if registry.middleware(middleware).takes_old_names else options


class BasePR2(BarePR2):
    """A PR2 that drives.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        with_keyboard: whether the arrow keys drive it.
        show_laser: whether the view shows the rays of its laser scanner.

    Attributes:
        motion: a `MotionXYW`.
        odometry: an `Odometry`.
        keyboard: a `Keyboard`.
    """

    def __init__(self, name: str | None = None, with_keyboard: bool = True, show_laser: bool = False) -> None:
        super().__init__(name)
        what = f"{type(self).__name__}({{}})"
        self._show_laser = checks.boolean(show_laser, what.format("show_laser"))
        self._equip("motion", _MotionXYW())
        self._equip("odometry", _Odometry())
        if checks.boolean(with_keyboard, what.format("with_keyboard")):
            self._equip("keyboard", _Keyboard())


class LocalizedPR2(BasePR2):
    """A PR2 that drives and knows where it is.

    Attributes:
        pose: a `Pose`.
    """

    def __init__(self, name: str | None = None, with_keyboard: bool = True, show_laser: bool = False) -> None:
        super().__init__(name, with_keyboard, show_laser)
        self._equip("pose", _Pose())


class NavPR2(BasePR2):
    """A PR2 that drives and scans the room.

    Attributes:
        base_scan: a `Hokuyo` in its base.
    """

    def __init__(self, name: str | None = None, with_keyboard: bool = True, show_laser: bool = False) -> None:
        super().__init__(name, with_keyboard, show_laser)
        scanner = _Hokuyo()
        scanner.translate(*_LASER)
        scanner.properties(Visible_arc=self._show_laser)
        self._equip("base_scan", scanner)
