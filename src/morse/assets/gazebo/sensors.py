"""The sensors of a URDF file: elements ``sensor``, and elements for Gazebo.

See http://wiki.ros.org/urdf/XML/sensor and http://sdformat.org/spec?elem=sensor.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.assets.gazebo.plugins import topic_of
from morse.assets.gazebo.values import ValueMistakeError, number, text_of
from morse.assets.xml_files import line_of
from morse.mathutils import Euler, Matrix
from morse.mathutils.rotations import nine
from morse.scene.component import DeclaredSensor

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Iterator, Mapping
    from xml.etree import ElementTree
    from xml.etree.ElementTree import Element

    from morse.assets.description import Link

#: fields of products, and where the standard deviations of their noise may be
_FIELDS: dict[str, dict[str, tuple[str, ...]]] = {
    "VideoCamera": {"image": (".//noise/stddev",)},
    "IMU": {
        "angular_velocity": (".//angular_velocity/x/noise/stddev", ".//noise/rate/stddev"),
        "linear_acceleration": (".//linear_acceleration/x/noise/stddev", ".//noise/accel/stddev"),
    },
    "GPS": {
        "x": (".//position_sensing/horizontal/noise/stddev",),
        "y": (".//position_sensing/horizontal/noise/stddev",),
        "z": (".//position_sensing/vertical/noise/stddev",),
    },
}
_ALL: dict[str, tuple[str, ...]] = {"": (".//noise/stddev",)}
#: pictures have values up to 255, those of Gazebo up to 1
_SCALES = {"VideoCamera": 255.0}


def noise_of(element: Element, product: str) -> Iterator[tuple[str, float]]:
    """The standard deviations of the white noise of a sensor: name of the field, or an empty one for all.

    Raises:
        ValueError: one is not a number.
    """
    for field, paths in _FIELDS.get(product, _ALL).items():
        try:
            deviation = next((value for path in paths if (value := number(element, path, 0.0)) > 0.0), 0.0)
        except ValueMistakeError as error:
            raise ValueError(f"its noise is wrong: {error}") from None
        if deviation:
            yield field, deviation * _SCALES.get(product, 1.0)


_PRODUCTS = {
    "camera": "VideoCamera",
    "wideanglecamera": "VideoCamera",
    "depth": "DepthVideoCamera",
    "depth_camera": "DepthVideoCamera",
    "rgbd": "DepthVideoCamera",
    "rgbd_camera": "DepthVideoCamera",
    "ray": "Hokuyo",
    "gpu_ray": "Hokuyo",
    "lidar": "Hokuyo",
    "gpu_lidar": "Hokuyo",
    "sonar": "UltrasonicRangeFinder",
    "imu": "IMU",
    "gps": "GPS",
    "navsat": "GPS",
    "magnetometer": "Magnetometer",
    "air_pressure": "Barometer",
    "air_speed": "Airspeed",
    "thermal": "ThermalCamera",
    "thermal_camera": "ThermalCamera",
    "segmentation": "SegmentationCamera",
    "segmentation_camera": "SegmentationCamera",
    "boundingbox_camera": "SemanticCamera",
    "logical_camera": "SemanticCamera",
    "altimeter": "Pose",
    "contact": "ContactForce",
    "force_torque": "ForceTorqueSensor",
}
_MOST_PIXELS, _MOST_RAYS = 4096, 100_000
_FARTHEST = 1e6


def sensors_of(robot: ElementTree.Element, links: Mapping[str, Link]) -> tuple[list[DeclaredSensor], list[str]]:
    """Return the sensors of a robot, and warnings about those that are left out."""
    return declared_sensors(_elements(robot), links, {name for name, link in links.items() if link.visuals})


def declared_sensors(
    elements: Iterable[tuple[ElementTree.Element, str]], links: Container[str], shown: Container[str] = ()
) -> tuple[list[DeclaredSensor], list[str]]:
    """Return the sensors of some elements, each with the name of its link, and warnings about those left out.

    Args:
        links: names of the links.
        shown: names of the links that show what is on them.
    """
    sensors: list[DeclaredSensor] = []
    unknown: list[str] = []
    wrong: list[str] = []
    for element, link in elements:
        name = element.get("name") or f"sensor{len(sensors)}"
        kind = _kind(element)
        if kind not in _PRODUCTS or link not in links:
            what = kind or "no type" if kind not in _PRODUCTS else f"on the link '{link:.60}', which does not exist"
            unknown.append(f"'{name:.60}' ({what:.80})")
            continue
        origin = f"the sensor '{name:.60}'{line_of(element)}"
        try:
            sensor = _sensor(element, name, kind, link)
        except ValueError as error:
            wrong.append(f"{origin} is left out: {error}")
        else:
            sensors.append(replace(sensor, has_own_visual=link in shown, origin=origin))
    if unknown:
        wrong.append(f"sensors that MORSE does not have are left out: {', '.join(unknown[:10])}")
    return sensors, wrong


def _elements(robot: ElementTree.Element) -> Iterator[tuple[ElementTree.Element, str]]:
    """The elements of sensors, and the links that carry them."""
    joints = {joint.get("name"): joint.find("child") for joint in robot.findall("joint")}
    of_gazebo = {element.get("name") for element in robot.iterfind("gazebo/sensor")}
    for element in robot.findall("sensor"):
        parent = element.find("parent")
        link = "" if parent is None else parent.get("link", "")
        if parent is not None and not link and parent.get("joint"):
            if element.get("name") in of_gazebo:
                continue  # the element of Gazebo says more about it
            child = joints.get(parent.get("joint"))
            link = "" if child is None else child.get("link", "")
        yield element, link
    for gazebo in robot.findall("gazebo"):
        for element in gazebo.findall("sensor"):
            place = gazebo.get("reference", "")
            # a force is measured in a joint, in the frame of its child
            child = joints.get(place) if _kind(element) == "force_torque" else None
            yield element, place if child is None else child.get("link", "")


def _kind(element: ElementTree.Element) -> str:
    kind = element.get("type")
    if kind is None:
        kind = next((child.tag for child in element if child.tag in ("camera", "ray")), "")
    return kind.lower()


def _sensor(element: ElementTree.Element, name: str, kind: str, link: str) -> DeclaredSensor:
    product = _PRODUCTS[kind]
    pose = _pose(element)
    properties: dict[str, float | int] = {}
    if "Camera" in product:
        properties = _camera(element)
    elif product == "Hokuyo":
        properties, middle = _scan(element)
        pose = pose @ Matrix.Rotation(middle, 4, "Z")
    elif product == "UltrasonicRangeFinder":
        properties = {"range": _positive(element, (".//max",), 4.0)}
    rate = _number(element, ("update_rate",), None)
    if rate is None and (text := element.get("update_rate")) is not None:
        rate = _finite(text, "update_rate")
    x, y, z = pose.translation
    return DeclaredSensor(
        name, product, link, (x, y, z), nine(list(pose.to_3x3())), tuple(properties.items()),
        rate if rate is not None and 0.0 < rate <= 10_000.0 else None, noise=tuple(noise_of(element, product)),
        stream=_stream(element),
    )  # fmt: skip


def _stream(element: ElementTree.Element) -> tuple[tuple[str, str | bool], ...]:
    """The topic that the sensor, or its plugin for ROS, names."""
    plugin = element.find("plugin")
    name = text_of(element, "topic")
    if plugin is not None:
        name = topic_of(plugin, name, "topicName", "cameraName", "camera_name", private="out")
    elif name:
        name = topic_of(element, "", "topic")
    return (("topic", name),) if name else ()


def _camera(element: ElementTree.Element) -> dict[str, float | int]:
    options: dict[str, float | int] = {}
    for name, paths in (("cam_width", (".//image/width",)), ("cam_height", (".//image/height",))):
        size = _number(element, paths, None)
        image = element.find(".//image")
        if size is None and image is not None and (text := image.get(name.removeprefix("cam_"))) is not None:
            size = _finite(text, name)
        if size is not None:
            options[name] = int(min(max(size, 1.0), _MOST_PIXELS))
    image = element.find(".//image")
    angle = _number(element, (".//horizontal_fov",), None)
    if angle is None and image is not None and (text := image.get("hfov")) is not None:
        angle = _finite(text, "hfov")
    if angle is not None:
        options["cam_fov"] = min(max(math.degrees(angle), 1.0), 179.0)
    near, far = _number(element, (".//clip/near",), None), _number(element, (".//clip/far",), None)
    if near is not None and far is not None and 0.0 < near < far:
        options |= {"cam_near": near, "cam_far": min(far, _FARTHEST)}
    return options


def _scan(element: ElementTree.Element) -> tuple[dict[str, float | int], float]:
    """Return the properties of a laser scanner, and the direction of the middle of its fan, rad."""
    options: dict[str, float | int] = {"laser_range": _positive(element, (".//range/max",), 30.0)}
    nearest = _number(element, (".//range/min",), 0.0) or 0.0
    if 0.0 < nearest < options["laser_range"]:
        options["range_min"] = nearest
    low, high = (
        _number(element, (".//horizontal/min_angle",), None),
        _number(element, (".//horizontal/max_angle",), None),
    )
    scan = element.find(".//horizontal")
    if scan is not None and scan.get("min_angle") is not None:
        low, high = _finite(scan.get("min_angle", ""), "min_angle"), _finite(scan.get("max_angle", "0"), "max_angle")
    if low is None or high is None or not low < high:
        return options, 0.0
    window = min(math.degrees(high - low), 360.0)
    sample_count = _number(element, (".//horizontal/samples",), None)
    if sample_count is None and scan is not None and scan.get("samples") is not None:
        sample_count = _finite(scan.get("samples", ""), "samples")
    samples = min(max(sample_count or 181.0, 2.0), _MOST_RAYS)
    options |= {"scan_window": window, "resolution": max(window / (samples - 1.0), 1e-3)}
    rows = _number(element, (".//vertical/samples",), None)
    if rows is not None and 2.0 <= rows <= 256.0:
        bottom, top = (_number(element, (f".//vertical/{name}_angle",), 0.0) or 0.0 for name in ("min", "max"))
        if top > bottom:
            options |= {"layers": int(rows), "layer_separation": math.degrees(top - bottom) / (int(rows) - 1)}
            options["layer_offset"] = 0.0
    return options, (low + high) / 2.0


def _pose(element: ElementTree.Element) -> Matrix:
    origin, pose = element.find("origin"), element.findtext("pose")
    words = (pose or "").split()
    if origin is not None:
        words = f"{origin.get('xyz', '0 0 0')} {origin.get('rpy', '0 0 0')}".split()
    if not words:
        return Matrix.Identity(4)
    if len(words) != 6:
        raise ValueError(f"its pose has {len(words)} numbers, expected 6")
    x, y, z, roll, pitch, yaw = (_finite(word, "pose") for word in words)
    matrix: Matrix = Euler((roll, pitch, yaw)).to_matrix().to_4x4()
    matrix.translation = (x, y, z)
    return matrix


def _number(element: ElementTree.Element, paths: tuple[str, ...], default: float | None) -> float | None:
    for path in paths:
        text = element.findtext(path)
        if text is not None:
            return _finite(text, path.rpartition("/")[2])
    return default


def _positive(element: ElementTree.Element, paths: tuple[str, ...], default: float) -> float:
    number = _number(element, paths, default) or default
    return min(max(number, 1e-3), _FARTHEST)


def _finite(text: str, name: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not abs(value) <= _FARTHEST:
        raise ValueError(f"its {name} is {text.strip()[:40]!r}, expected a number")
    return value
