"""The PR2 with different equipment; the component class is `morse.robots.pr2.PR2`."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.builder.components.armatures import Armature
from morse.builder.components.compound import CompoundSensor
from morse.builder.components.lasers import LaserSensorWithArc
from morse.builder.components.robot import GroundRobot
from morse.builder.creator import ActuatorCreator, SensorCreator
from morse.builder.errors import checks
from morse.middleware import registry

if TYPE_CHECKING:
    from morse.builder.abstractcomponent import AbstractComponent
    from morse.core.values import Options

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
