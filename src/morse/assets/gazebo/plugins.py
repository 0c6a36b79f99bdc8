"""Plugins of Gazebo and ROS that stand for actuators and sensors of MORSE."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo import drives, flight
from morse.assets.gazebo.values import ValueMistakeError
from morse.mathutils import Matrix
from morse.mathutils.rotations import nine
from morse.scene.declared_sensor import DeclaredSensor

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from xml.etree.ElementTree import Element

    from morse.assets.urdf.document import Joint

#: names between the names of nested models
_SEPARATOR = "::"
#: words in the names of plugins whose work MORSE does without them
_USUAL = (
    "physics", "scenebroadcaster", "usercommands", "sensors", "imu", "contact", "navsat", "altimeter", "magnetometer",
    "airpressure", "air_pressure", "posepublisher", "pose_publisher", "bumper",
    "jointposition", "joint-position", "jointtrajectory", "joint-trajectory", "jointcontroller", "joint-controller",
    "pose-publisher", "scene-broadcaster", "user-commands", "camera", "laser", "gps", "lidar", "logicalcamera",
    "ray_sensor", "openni", "kinect", "depth", "ros_control", "ros2_control", "ros_init",
    "gazebo_ros_api", "mimic",
)  # fmt: skip
Properties = dict[str, float | int | str]
Options = dict[str, str | bool]


class Plugins:
    """Converts the plugins of a model.

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
    """

    def __init__(
        self, joints: dict[str, Joint], links: list[str], prefix: str, body: str, warn: Callable[[str], None]
    ) -> None:
        self.joints, self.links, self.prefix, self.body, self._warn = joints, links, prefix, body, warn
        self.driven: set[str] = set()
        self.torques: dict[str, float] = {}
        self.actuators: list[DeclaredSensor] = []
        self.sensors: list[DeclaredSensor] = []

    def read(self, elements: Iterable[tuple[Element, str]]) -> None:
        """Convert plugins.

        Args:
            elements: each with the prefix of the names in its model.
        """
        unknown: list[str] = []
        for element, prefix in elements:
            word = _word(element)
            convert = next((method for key, method in _METHODS.items() if key in word), None)
            if convert is None:
                if not any(usual in word for usual in _USUAL):
                    unknown.append(_name(element))
                continue
            try:
                convert(self, element, prefix)
            except ValueMistakeError as error:
                self._warn(f"the plugin '{(element.get('name') or '')[:80]}' is left out: {error}")
        if unknown:
            self._warn(f"plugins that MORSE does not have are left out: {', '.join(dict.fromkeys(unknown))[:400]}")

    # -- parts -------------------------------------------------------------------------------

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
                stream=tuple((options or {}).items()),
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
                stream=tuple(options.items()),
            )
        )  # fmt: skip


def unknown_plugins(elements: Iterable[Element]) -> list[str]:
    """The names of plugins whose work MORSE does not do by itself."""
    return [_name(one) for one in elements if not any(usual in _word(one) for usual in _USUAL)]


def _word(element: Element) -> str:
    return f"{element.get('name') or ''} {element.get('filename') or ''}".lower()


def _name(element: Element) -> str:
    return (element.get("name") or element.get("filename") or "?")[:60]


#: words in the names of plugins, and what converts them
_METHODS: dict[str, Callable[[Plugins, Element, str], None]] = {
    "diffdrive": drives.diff_drive,
    "diff_drive": drives.diff_drive,
    "diff-drive": drives.diff_drive,
    "skidsteer": drives.diff_drive,
    "skid_steer": drives.diff_drive,
    "ackermann": drives.ackermann,
    "mecanum": drives.any_direction,
    "planar_move": drives.any_direction,
    "planarmove": drives.any_direction,
    "velocitycontrol": drives.any_direction,
    "velocity-control": drives.any_direction,
    "jointstatepublisher": drives.joint_states,
    "joint_state_publisher": drives.joint_states,
    "joint-state-publisher": drives.joint_states,
    "odometrypublisher": drives.odometry,
    "odometry-publisher": drives.odometry,
    "odometry_publisher": drives.odometry,
    "multicopter-motor-model": flight.propeller,
    "multicoptermotormodel": flight.propeller,
    "gazebo_motor_model": flight.propeller,
    "systems::thruster": flight.thruster,
    "thruster-system": flight.thruster,
    "liftdrag": flight.lift_drag,
    "lift-drag": flight.lift_drag,
    "buoyancy": flight.buoyancy,
    "hydrodynamics": flight.buoyancy,
}
