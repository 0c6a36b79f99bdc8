"""Plugins of Gazebo and ROS that stand for actuators and sensors of MORSE."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, boolean, number, text_of, vector
from morse.assets.xml_files import line_of
from morse.mathutils import Matrix, Vector
from morse.mathutils.rotations import nine
from morse.scene import Control
from morse.scene.component import DeclaredSensor

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from xml.etree.ElementTree import Element

    from morse.assets.description import Joint, RobotDescription


def propeller(plugins: Plugins, element: Element, prefix: str) -> None:
    """A propeller with its motor."""
    joint = plugins.joint(text_of(element, "jointName"), prefix)
    is_counter = text_of(element, "turningDirection", "ccw").lower() != "cw"
    properties: Properties = {
        "Joint": joint,
        "MotorConstant": number(element, "motorConstant", 8.54858e-06),
        "MomentConstant": number(element, "momentConstant", 0.016),
        "RotorDrag": number(element, "rotorDragCoefficient", 1.0e-4),
        "RollingMoment": number(element, "rollingMomentCoefficient", 1.0e-6),
        "Direction": 1.0 if is_counter else -1.0,
        "TimeConstantUp": number(element, "timeConstantUp", 1.0 / 80.0),
        "TimeConstantDown": number(element, "timeConstantDown", 1.0 / 40.0),
        "MaxSpeed": number(element, "maxRotVelocity", 838.0),
        "Slowdown": number(element, "rotorVelocitySlowdownSim", 10.0),
    }
    plugins.add(joint, "Propeller", properties, plugins.link(text_of(element, "linkName"), prefix))


def thruster(plugins: Plugins, element: Element, prefix: str) -> None:
    """A propeller under water."""
    joint = plugins.joints[plugins.joint(text_of(element, "joint_name"), prefix)]
    diameter = number(element, "propeller_diameter", 0.02)
    # the thrust is C rho D^4 w^2
    constant = number(element, "thrust_coefficient", 1.0) * number(element, "fluid_density", 1000.0) * diameter**4
    link = joint.child.removeprefix(plugins.prefix)
    turn = Vector((0.0, 0.0, 1.0)).rotation_difference(joint.axis).to_matrix().to_4x4()
    pose = turn if joint.anchor is None else joint.anchor @ turn
    properties: Properties = {
        "Joint": joint.name, "MotorConstant": abs(constant), "MomentConstant": 0.0, "TimeConstantUp": 0.0,
        "TimeConstantDown": 0.0, "MaxSpeed": 1e5, "Slowdown": 1.0,
    }  # fmt: skip
    plugins.add(joint.name, "Propeller", properties, link, pose)


def lift_drag(plugins: Plugins, element: Element, prefix: str) -> None:
    """A wing."""
    forward = Vector(vector(element, "forward", (1.0, 0.0, 0.0)))
    upward = Vector(vector(element, "upward", (0.0, 0.0, 1.0)))
    if min(forward.length, upward.length, forward.cross(upward).length) < 1e-9:
        raise ValueMistakeError("<forward> and <upward> are no two directions")
    forward, side = forward.normalized(), upward.cross(forward).normalized()
    up = forward.cross(side)
    pose = Matrix([list(row) for row in zip(forward, side, up, strict=True)]).to_4x4()
    pose.translation = vector(element, "cp", (0.0, 0.0, 0.0))
    flap = text_of(element, "control_joint_name")
    properties: Properties = {
        "Area": number(element, "area", 1.0),
        "Density": number(element, "air_density", 1.2041),
        "ZeroAngle": number(element, "a0", 0.0),
        "StallAngle": min(number(element, "alpha_stall", 0.5 * math.pi), 1.6),
        "LiftSlope": number(element, "cla", 1.0),
        "DragSlope": number(element, "cda", 0.01),
        "MomentSlope": number(element, "cma", 0.0),
        "LiftSlopeStalled": number(element, "cla_stall", 0.0),
        "DragSlopeStalled": number(element, "cda_stall", 1.0),
        "MomentSlopeStalled": number(element, "cma_stall", 0.0),
    }
    if flap:
        properties |= {
            "Joint": plugins.joint(flap, prefix),
            "FlapLift": number(element, "control_joint_rad_to_cl", 4.0),
        }
    link = plugins.link(text_of(element, "link_name"), prefix)
    plugins.add("wing", "LiftDrag", properties, link, pose)


def buoyancy(plugins: Plugins, element: Element, prefix: str) -> None:
    """Water around the model."""
    del element, prefix
    if not any(one.product == "Hydrodynamics" for one in plugins.actuators):
        plugins.add("water", "Hydrodynamics", {})


#: names between the names of nested models
_SEPARATOR = "::"
Properties = dict[str, float | int | str]
Options = dict[str, str | bool]


class Plugins:
    """Collects what the plugins of a model stand for.

    Args:
        joints: of the model, by name.
        links: names of its links, the one that carries the others first.
        prefix: what the names of the links begin with in the scene.
        body: name of the node of the model, below which ``<body>_joints`` is the armature of the joints.
        warn: receives what is left out.

    Attributes:
        actuators, sensors: what the plugins stand for.
        driven: names of the joints that they move.
        torques: of the motors of joints, N m, as the plugins limit them.
        element: the plugin that is read, for messages.
    """

    def __init__(
        self, joints: dict[str, Joint], links: list[str], prefix: str, body: str, warn: Callable[[str], None]
    ) -> None:
        self.joints, self.links, self.prefix, self.body, self.warn = joints, links, prefix, body, warn
        self.driven: set[str] = set()
        self.torques: dict[str, float] = {}
        self.actuators: list[DeclaredSensor] = []
        self.sensors: list[DeclaredSensor] = []
        self.element: Element | None = None

    @property
    def origin(self) -> str:
        """The plugin that is read, for messages; empty for none."""
        one = self.element
        return "" if one is None else f"the plugin '{(one.get('name') or '')[:80]}'{line_of(one)}"

    def named(self, element: Element, prefix: str, *tags: str) -> str:
        """The joints in some elements, separated by commas."""
        names = [(child.text or "").strip() for tag in tags for child in element.findall(tag)]
        return ", ".join(self.joint(name, prefix) for name in names if name)

    def joint(self, name: str, prefix: str) -> str:
        """The name of a joint in the scene, which the plugin moves."""
        for candidate in (f"{prefix}{name}", name, name.rpartition(_SEPARATOR)[2]):
            if candidate in self.joints:
                self.driven.add(candidate)
                return candidate
        raise ValueMistakeError(f"the model has no joint '{name[:60]}'")

    def link(self, name: str, prefix: str) -> str:
        """The name of a link in the scene, without the prefix of the model."""
        for candidate in (f"{prefix}{name}", name):
            if candidate in self.links:
                return candidate
        raise ValueMistakeError(f"the model has no link '{name[:60]}'")

    def add(
        self,
        name: str,
        product: str,
        properties: Properties,
        link: str = "",
        pose: Matrix | None = None,
        options: Options | None = None,
    ) -> None:
        """Add an actuator to a link, by default the one that carries the others."""
        place = pose or Matrix.Identity(4)
        x, y, z = place.translation
        rotation = nine(list(place.to_3x3()))
        self.actuators.append(
            DeclaredSensor(
                name, product, f"{self.prefix}{link or self.links[0]}", (x, y, z), rotation, tuple(properties.items()),
                stream=tuple((options or {}).items()), origin=self.origin,
            )
        )  # fmt: skip

    def measure(self, name: str, product: str, options: Options, frequency: float, *, joints: bool = False) -> None:
        """Add a sensor to the body or the joints, unless the model has one of that name."""
        if any(one.name == name for one in self.sensors):
            return
        self.sensors.append(
            DeclaredSensor(
                name, product, f"{self.body}_joints" if joints else self.body, (0.0, 0.0, 0.0),
                nine(list(Matrix.Identity(3))), frequency=frequency if 0.0 < frequency <= 10_000.0 else None,
                stream=tuple(options.items()), origin=self.origin,
            )
        )  # fmt: skip


def prepare_motors(document: RobotDescription, plugins: Plugins) -> None:
    """Set the largest efforts of driven wheels; the wheels of a body that plugins move roll freely."""
    is_pushed = any(one.product == "MotionXYW" for one in plugins.actuators)
    for joint in document.joints:
        torque = plugins.torques.get(joint.name)
        if torque is not None:
            joint.dynamics = replace(joint.dynamics, effort=min(torque, joint.dynamics.effort))
        elif is_pushed and joint.kind in ("revolute", "continuous") and not joint.dynamics.limited:
            joint.dynamics = replace(joint.dynamics, control=Control.EFFORT)


_NAME = re.compile(r"/?[A-Za-z_][A-Za-z0-9_]*(/[A-Za-z_][A-Za-z0-9_]*)*")


def topic_of(element: Element, usual: str, *tags: str, private: str = "") -> str:
    """Return the topic of a plugin or a sensor.

    A name without a leading slash is below the namespace of the robot.

    Args:
        usual: the name that the plugin has if the file sets none; it may be remapped.
        tags: elements that may contain the name.
        private: the name that ``<remapping>~/out:=scan</remapping>`` replaces.
    """
    name = next((text for tag in tags if (text := text_of(element, tag))), usual)
    ros = element.find("ros")
    for tag in ("remapping", "argument"):
        for remapping in () if ros is None else ros.findall(tag):
            before, _, after = (remapping.text or "").strip().partition(":=")
            if after.strip() and before.strip().removeprefix("~/") in (usual, private, name):
                name = after.strip()
    name = name.removeprefix("~/").replace("::", "/")
    space = (text_of(ros, "namespace") or text_of(element, "robotNamespace")).strip("/")
    if space and not name.startswith("/"):
        name = f"/{space}/{name}"
    return name if _NAME.fullmatch(name) else usual


_LEFT = ("left_joint", "leftJoint", "leftFrontJoint", "leftRearJoint", "leftMidJoint", "left_wheel_joint")
_RIGHT = ("right_joint", "rightJoint", "rightFrontJoint", "rightRearJoint", "rightMidJoint", "right_wheel_joint")
_COMMANDS = ("topic", "command_topic", "commandTopic", "topicName")
_ODOMETRY = ("odom_topic", "odometry_topic", "odometryTopic")
#: whether the odometry is a transform
_TRANSFORM = ("publish_odom_tf", "publishOdomTF", "publishTf", "broadcastTF", "publish_tf")
#: properties of speeds, and the elements that may contain them
_LIMITS = {
    "MaxSpeed": ("max_linear_velocity", "max_speed"),
    "MaxAngularSpeed": ("max_angular_velocity",),
    "MaxAcceleration": ("max_linear_acceleration",),
    "MaxAngularAcceleration": ("max_angular_acceleration",),
}


def diff_drive(plugins: Plugins, element: Element, prefix: str) -> None:
    """Wheels on the left and on the right."""
    properties: Properties = {
        "LeftWheels": plugins.named(element, prefix, *_LEFT),
        "RightWheels": plugins.named(element, prefix, *_RIGHT),
        "WheelRadius": _radius(element),
        "WheelSeparation": _first(element, "wheel_separation", "wheelSeparation"),
    }
    if not (properties["LeftWheels"] and properties["RightWheels"]):
        raise ValueMistakeError("it names no joints")
    torque = _first(element, "max_wheel_torque", "wheelTorque", "torque")
    if torque > 0.0:
        plugins.torques |= dict.fromkeys(plugins.driven, torque)
    _drive(plugins, element, "MotionVWDiff", properties)


def ackermann(plugins: Plugins, element: Element, prefix: str) -> None:
    """Two wheels that steer, two that drive."""
    properties: Properties = {
        "LeftWheels": plugins.named(element, prefix, "left_joint", "rear_left_joint"),
        "RightWheels": plugins.named(element, prefix, "right_joint", "rear_right_joint"),
        "LeftSteering": plugins.named(element, prefix, "left_steering_joint"),
        "RightSteering": plugins.named(element, prefix, "right_steering_joint"),
        "WheelRadius": _radius(element),
        "WheelBase": _first(element, "wheel_base"),
        "WheelSeparation": _first(element, "wheel_separation"),
        "SteeringLimit": min(max(_first(element, "steering_limit", "max_steer") or 0.5, 1e-3), 1.5),
    }
    if not all(properties[name] for name in list(properties)[:4]):
        raise ValueMistakeError("it names no joints")
    _drive(plugins, element, "MotionVWAckermann", properties)


def any_direction(plugins: Plugins, element: Element, prefix: str) -> None:
    """A body that is moved, and whose wheels roll freely."""
    del prefix
    _drive(plugins, element, "MotionXYW", {})


def odometry(plugins: Plugins, element: Element, prefix: str) -> None:
    """The pose relative to the start."""
    del prefix
    if not boolean(element, "publish_odom", True):
        return
    is_transform = all(boolean(element, tag, True) for tag in _TRANSFORM)
    rate = _first(element, "odom_publish_frequency", "publish_rate", "update_rate", "updateRate", "odometryRate")
    plugins.measure("odom", "Odometry", {"topic": topic_of(element, "odom", *_ODOMETRY), "tf": is_transform}, rate)


def joint_states(plugins: Plugins, element: Element, prefix: str) -> None:
    """The positions of the joints."""
    del prefix
    options: Options = {"topic": topic_of(element, "joint_states", "topic")}
    plugins.measure("joint_states", "ArmaturePose", options, _first(element, "update_rate", "updateRate"), joints=True)


def _drive(plugins: Plugins, element: Element, product: str, properties: Properties) -> None:
    limits = {name: _first(element, *tags) for name, tags in _LIMITS.items()}
    properties |= {name: limit for name, limit in limits.items() if limit > 0.0}
    plugins.add("motion", product, properties, options={"topic": topic_of(element, "cmd_vel", *_COMMANDS)})
    odometry(plugins, element, "")


def _radius(element: Element) -> float:
    """The radius of the wheels, m; 0 if the file does not contain it."""
    return number(element, "wheel_radius", 0.5 * _first(element, "wheel_diameter", "wheelDiameter"))


def _first(element: Element, *tags: str) -> float:
    """The first of some numbers, or 0."""
    return next((value for tag in tags if (value := number(element, tag, 0.0))), 0.0)


#: words in the names of plugins whose work MORSE does without them
_USUAL = (
    "physics", "scenebroadcaster", "usercommands", "sensors", "imu", "contact", "navsat", "altimeter", "magnetometer",
    "airpressure", "air_pressure", "posepublisher", "pose_publisher", "bumper",
    "jointposition", "joint-position", "jointtrajectory", "joint-trajectory", "jointcontroller", "joint-controller",
    "pose-publisher", "scene-broadcaster", "user-commands", "camera", "laser", "gps", "lidar", "logicalcamera",
    "ray_sensor", "openni", "kinect", "depth", "ros_control", "ros2_control", "ros_init",
    "gazebo_ros_api", "mimic",
)  # fmt: skip
#: plugins that are sensors themselves, and do not send what a sensor of the file measures
_SENSORS = ("gazebo_ros_imu.so", "hector_gazebo_ros_")


def read_plugins(plugins: Plugins, elements: Iterable[tuple[Element, str]]) -> None:
    """Convert plugins.

    Args:
        plugins: receives what they stand for.
        elements: each with the prefix of the names in its model.
    """
    unknown: list[str] = []
    for element, prefix in elements:
        word = _word(element)
        convert = next((method for key, method in _METHODS.items() if key in word), None)
        if convert is None:
            if not _is_usual(word):
                unknown.append(_name(element))
            continue
        plugins.element = element
        try:
            convert(plugins, element, prefix)
        except ValueMistakeError as error:
            plugins.warn(f"{plugins.origin} is left out: {error}")
        plugins.element = None
    if unknown:
        plugins.warn(f"plugins that MORSE does not have are left out: {', '.join(dict.fromkeys(unknown))[:400]}")


def unknown_plugins(elements: Iterable[Element]) -> list[str]:
    """The names of plugins whose work MORSE does not do by itself."""
    return [_name(one) for one in elements if not _is_usual(_word(one))]


def _is_usual(word: str) -> bool:
    return any(usual in word for usual in _USUAL) and not any(sensor in word for sensor in _SENSORS)


def _word(element: Element) -> str:
    return f"{element.get('name') or ''} {element.get('filename') or ''}".lower()


def _name(element: Element) -> str:
    return (element.get("name") or element.get("filename") or "?")[:60]


#: words in the names of plugins, and what converts them
_METHODS: dict[str, Callable[[Plugins, Element, str], None]] = {
    "diffdrive": diff_drive,
    "diff_drive": diff_drive,
    "diff-drive": diff_drive,
    "skidsteer": diff_drive,
    "skid_steer": diff_drive,
    "ackermann": ackermann,
    "mecanum": any_direction,
    "planar_move": any_direction,
    "planarmove": any_direction,
    "velocitycontrol": any_direction,
    "velocity-control": any_direction,
    "jointstatepublisher": joint_states,
    "joint_state_publisher": joint_states,
    "joint-state-publisher": joint_states,
    "odometrypublisher": odometry,
    "odometry-publisher": odometry,
    "odometry_publisher": odometry,
    "multicopter-motor-model": propeller,
    "multicoptermotormodel": propeller,
    "gazebo_motor_model": propeller,
    "systems::thruster": thruster,
    "thruster-system": thruster,
    "liftdrag": lift_drag,
    "lift-drag": lift_drag,
    "buoyancy": buoyancy,
    "hydrodynamics": buoyancy,
}
