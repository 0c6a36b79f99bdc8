"""Plugins of Gazebo that stand for actuators of MORSE."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.assets.sdf.scope import SEPARATOR
from morse.assets.sdf.values import ValueMistakeError, number, text_of, vector
from morse.mathutils import Matrix, Vector
from morse.mathutils.rotations import nine
from morse.scene.declared_sensor import DeclaredSensor

if TYPE_CHECKING:
    from collections.abc import Callable
    from xml.etree.ElementTree import Element

    from morse.assets.sdf.scope import Scope
    from morse.assets.urdf.document import Joint

#: words in the names of plugins whose work MORSE does without them
_USUAL = (
    "physics", "scenebroadcaster", "usercommands", "sensors", "imu", "contact", "navsat", "altimeter", "magnetometer",
    "airpressure", "air_pressure", "jointstatepublisher", "joint_state_publisher", "posepublisher", "pose_publisher",
    "jointposition", "joint-position", "jointtrajectory", "joint-trajectory", "jointcontroller", "joint-controller",
    "joint-state-publisher", "pose-publisher", "scene-broadcaster", "user-commands", "odometry-publisher",
    "odometrypublisher", "odometry_publisher", "camera", "laser", "gps", "lidar", "logicalcamera",
)  # fmt: skip
_Properties = dict[str, float | int | str]


class Plugins:
    """Converts the plugins of a model.

    Args:
        joints: of the model, by name.
        links: names of its links, the one that carries the others first.
        prefix: what the names of the links begin with in the scene.
        warn: receives what is left out.

    Attributes:
        actuators: what the plugins stand for.
        driven: names of the joints that they move.
    """

    def __init__(self, joints: dict[str, Joint], links: list[str], prefix: str, warn: Callable[[str], None]) -> None:
        self._joints, self._links, self._prefix, self._warn = joints, links, prefix, warn
        self.driven: set[str] = set()
        self.actuators: list[DeclaredSensor] = []
        self._unknown: list[str] = []

    def read(self, model: Scope, prefix: str = "") -> None:
        """Convert the plugins of a model and its nested models."""
        for element, _ in model.plugins:
            word = _word(element)
            convert = next((method for key, method in _METHODS.items() if key in word), None)
            if convert is None:
                if not any(usual in word for usual in _USUAL):
                    self._unknown.append(_name(element))
                continue
            try:
                convert(self, element, prefix)
            except ValueMistakeError as error:
                self._warn(f"the plugin '{(element.get('name') or '')[:80]}' is left out: {error}")
        for name, nested in model.models.items():
            self.read(nested, f"{prefix}{name}{SEPARATOR}")
        if not prefix and self._unknown:
            self._warn(
                f"plugins that MORSE does not have are left out: {', '.join(dict.fromkeys(self._unknown))[:400]}"
            )

    def read_world(self, world: Scope) -> None:
        """Name the plugins of a world that are left out; its models have their own."""
        words = [(element, _word(element)) for element, _ in world.plugins]
        names = [_name(element) for element, word in words if not any(usual in word for usual in _USUAL)]
        if names:
            self._warn(f"plugins of the world are left out: {', '.join(dict.fromkeys(names))[:400]}")

    # -- parts -------------------------------------------------------------------------------

    def _named(self, element: Element, prefix: str, *tags: str) -> str:
        """The joints in some elements, separated by commas."""
        names = [(child.text or "").strip() for tag in tags for child in element.findall(tag)]
        return ", ".join(self._joint(name, prefix) for name in names if name)

    def _joint(self, name: str, prefix: str) -> str:
        for candidate in (f"{prefix}{name}", name, name.rpartition(SEPARATOR)[2]):
            if candidate in self._joints:
                self.driven.add(candidate)
                return candidate
        raise ValueMistakeError(f"the model has no joint '{name[:60]}'")

    def _link(self, name: str, prefix: str) -> str:
        for candidate in (f"{prefix}{name}", name):
            if candidate in self._links:
                return candidate
        raise ValueMistakeError(f"the model has no link '{name[:60]}'")

    def _add(
        self, name: str, product: str, properties: _Properties, link: str = "", pose: Matrix | None = None
    ) -> None:
        place = pose or Matrix.Identity(4)
        x, y, z = place.translation
        rotation = nine(list(place.to_3x3()))
        self.actuators.append(
            DeclaredSensor(
                name, product, f"{self._prefix}{link or self._links[0]}", (x, y, z), rotation, tuple(properties.items())
            )
        )

    def _diff_drive(self, element: Element, prefix: str) -> None:
        diameter = number(element, "wheel_diameter", number(element, "wheelDiameter", 0.2))
        properties: _Properties = {
            "LeftWheels": self._named(element, prefix, "left_joint", "leftJoint"),
            "RightWheels": self._named(element, prefix, "right_joint", "rightJoint"),
            "WheelRadius": number(element, "wheel_radius", 0.5 * diameter),
            "WheelSeparation": number(element, "wheel_separation", number(element, "wheelSeparation", 0.34)),
        }
        if not (properties["LeftWheels"] and properties["RightWheels"]):
            raise ValueMistakeError("it names no joints")
        self._add("motion", "MotionVWDiff", properties | _speed_limits(element))

    def _ackermann(self, element: Element, prefix: str) -> None:
        properties: _Properties = {
            "LeftWheels": self._named(element, prefix, "left_joint"),
            "RightWheels": self._named(element, prefix, "right_joint"),
            "LeftSteering": self._named(element, prefix, "left_steering_joint"),
            "RightSteering": self._named(element, prefix, "right_steering_joint"),
            "WheelRadius": number(element, "wheel_radius", 0.2),
            "WheelBase": number(element, "wheel_base", 1.0),
            "WheelSeparation": number(element, "wheel_separation", 1.0),
            "SteeringLimit": min(max(number(element, "steering_limit", 0.5), 1e-3), 1.5),
        }
        if not all(properties[name] for name in list(properties)[:4]):
            raise ValueMistakeError("it names no joints")
        self._add("motion", "MotionVWAckermann", properties | _speed_limits(element))

    def _propeller(self, element: Element, prefix: str) -> None:
        joint = self._joint(text_of(element, "jointName"), prefix)
        is_counter = text_of(element, "turningDirection", "ccw").lower() != "cw"
        properties: _Properties = {
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
        self._add(joint, "Propeller", properties, self._link(text_of(element, "linkName"), prefix))

    def _thruster(self, element: Element, prefix: str) -> None:
        joint = self._joints[self._joint(text_of(element, "joint_name"), prefix)]
        diameter = number(element, "propeller_diameter", 0.02)
        # the thrust is C rho D^4 w^2
        constant = number(element, "thrust_coefficient", 1.0) * number(element, "fluid_density", 1000.0) * diameter**4
        link = joint.child.removeprefix(self._prefix)
        turned = Vector((0.0, 0.0, 1.0)).rotation_difference(joint.axis).to_matrix().to_4x4()
        pose = turned if joint.anchor is None else joint.anchor @ turned
        properties: _Properties = {
            "Joint": joint.name, "MotorConstant": abs(constant), "MomentConstant": 0.0, "TimeConstantUp": 0.0,
            "TimeConstantDown": 0.0, "MaxSpeed": 1e5, "Slowdown": 1.0,
        }  # fmt: skip
        self._add(joint.name, "Propeller", properties, link, pose)

    def _lift_drag(self, element: Element, prefix: str) -> None:
        forward = Vector(vector(element, "forward", (1.0, 0.0, 0.0)))
        upward = Vector(vector(element, "upward", (0.0, 0.0, 1.0)))
        if min(forward.length, upward.length, forward.cross(upward).length) < 1e-9:
            raise ValueMistakeError("<forward> and <upward> are no two directions")
        forward, side = forward.normalized(), upward.cross(forward).normalized()
        up = forward.cross(side)
        pose = Matrix([list(row) for row in zip(forward, side, up, strict=True)]).to_4x4()
        pose.translation = vector(element, "cp", (0.0, 0.0, 0.0))
        flap = text_of(element, "control_joint_name")
        properties: _Properties = {
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
                "Joint": self._joint(flap, prefix),
                "FlapLift": number(element, "control_joint_rad_to_cl", 4.0),
            }
        link = self._link(text_of(element, "link_name"), prefix)
        self._add("wing", "LiftDrag", properties, link, pose)

    def _buoyancy(self, element: Element, prefix: str) -> None:
        del element, prefix
        if not any(one.product == "Hydrodynamics" for one in self.actuators):
            self._add("water", "Hydrodynamics", {})


def _word(element: Element) -> str:
    return f"{element.get('name') or ''} {element.get('filename') or ''}".lower()


def _name(element: Element) -> str:
    return (element.get("name") or element.get("filename") or "?")[:60]


def _speed_limits(element: Element) -> _Properties:
    tags = {
        "max_linear_velocity": "MaxSpeed",
        "max_angular_velocity": "MaxAngularSpeed",
        "max_linear_acceleration": "MaxAcceleration",
        "max_angular_acceleration": "MaxAngularAcceleration",
    }
    limits = {name: number(element, tag, 0.0) for tag, name in tags.items()}
    return {name: limit for name, limit in limits.items() if limit > 0.0}


#: words in the names of plugins, and what converts them
_METHODS: dict[str, Callable[[Plugins, Element, str], None]] = {
    "diffdrive": Plugins._diff_drive,
    "diff_drive": Plugins._diff_drive,
    "diff-drive": Plugins._diff_drive,
    "skidsteer": Plugins._diff_drive,
    "ackermann": Plugins._ackermann,
    "multicopter-motor-model": Plugins._propeller,
    "multicoptermotormodel": Plugins._propeller,
    "gazebo_motor_model": Plugins._propeller,
    "systems::thruster": Plugins._thruster,
    "thruster-system": Plugins._thruster,
    "liftdrag": Plugins._lift_drag,
    "lift-drag": Plugins._lift_drag,
    "buoyancy": Plugins._buoyancy,
    "hydrodynamics": Plugins._buoyancy,
}
