"""Plugins of Gazebo and ROS that stand for actuators and sensors of MORSE."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.gazebo import drives, flight
from morse.assets.gazebo.values import ValueMistakeError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from xml.etree.ElementTree import Element

    from morse.assets.gazebo.converted import Plugins

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
        try:
            convert(plugins, element, prefix)
        except ValueMistakeError as error:
            plugins.warn(f"the plugin '{(element.get('name') or '')[:80]}' is left out: {error}")
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
