"""The sensors and cameras of an MJCF model."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.assets.mjcf.joints import pose
from morse.mathutils import Matrix
from morse.mathutils.rotations import nine
from morse.scene.component import DeclaredSensor

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.assets.mjcf.model import ModelData

#: quantities that `ArmaturePose` and the motors already measure
_OF_JOINTS = ("joint", "actuator", "tendon", "ball")
_PRODUCTS = {
    "camera": "VideoCamera",
    "rangefinder": "Infrared",
    "accelerometer": "IMU",
    "gyro": "IMU",
    "magnetometer": "Magnetometer",
    "force": "ForceTorqueSensor",
    "torque": "ForceTorqueSensor",
    "touch": "ContactForce",
    "velocimeter": "Velocity",
    "framelinvel": "Velocity",
    "frameangvel": "Velocity",
    "framepos": "Pose",
    "framequat": "Pose",
    "framexaxis": "Pose",
    "frameyaxis": "Pose",
    "framezaxis": "Pose",
    "clock": "Clock",
}
#: sensors of which each measures something else, also at one place
_SINGLE = ("VideoCamera", "Infrared")
_MOST_PIXELS = 4096
#: cameras look along -Z with +Y up, range finders along +Z; sensors of MORSE look along +X with +Z up
_FROM_CAMERA = Matrix(((0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0))).to_4x4()
_FROM_FINDER = Matrix(((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))).to_4x4()


def sensors_of(model: ModelData, links: Mapping[int, str]) -> tuple[list[DeclaredSensor], list[str]]:
    """Return the sensors of a model, and warnings about those that are left out.

    An accelerometer and a gyroscope with the same pose become one IMU.

    Args:
        links: names of the nodes by body.
    """
    by_site: dict[tuple[object, ...], DeclaredSensor] = {}
    unknown: list[str] = []
    for sensor in model.sensors:
        product = _PRODUCTS.get(sensor.kind)
        if sensor.kind.startswith(_OF_JOINTS):
            continue
        if product is None or (sensor.body not in links and product != "Clock"):
            unknown.append(f"'{sensor.name:.60}' ({sensor.kind})")
            continue
        place = pose(sensor.position, sensor.quaternion)
        properties: tuple[tuple[str, float | int], ...] = ()
        if sensor.kind == "camera":
            place = place @ _FROM_CAMERA
            properties = _view(*sensor.values)
        elif sensor.kind == "rangefinder":
            place = place @ _FROM_FINDER
            if math.isfinite(sensor.values[0]) and sensor.values[0] > 0.0:
                properties = (("range", min(max(sensor.values[0], 1e-3), 1e6)),)
        x, y, z = place.translation
        declaration = DeclaredSensor(
            sensor.name, product, links.get(sensor.body, ""), (x, y, z), nine(list(place.to_3x3())), properties
        )
        own = (sensor.name,) if product in _SINGLE else ()
        # the contacts are those of the whole body
        where = () if product == "ContactForce" else (sensor.position, sensor.quaternion)
        by_site.setdefault((product, sensor.body, *where, *own), declaration)
    warnings = []
    if unknown:
        more = f" and {len(unknown) - 10} more" if len(unknown) > 10 else ""
        warnings.append(f"sensors that MORSE does not have are left out: {', '.join(unknown[:10])}{more}")
    return list(by_site.values()), warnings


def _view(angle: float, width: float, height: float) -> tuple[tuple[str, float | int], ...]:
    """Return the properties of a camera.

    Args:
        angle: vertical field of view, deg.
        width, height: pixels; 1 for those of MORSE, whose images are square then.
    """
    size: tuple[tuple[str, float | int], ...] = ()
    if min(width, height) > 1.0:
        wide, high = (int(min(pixels, _MOST_PIXELS)) for pixels in (width, height))
        size = (("cam_width", wide), ("cam_height", high))
        angle = 2.0 * math.degrees(math.atan(math.tan(math.radians(min(angle, 179.0)) / 2.0) * wide / high))
    return (*size, ("cam_fov", min(max(angle, 1.0), 179.0)))
