"""Builder classes of sensors with methods, parts or arguments of their own."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from morse.assets import solids
from morse.builder import workspace
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.creator import ComponentCreator, SensorCreator
from morse.builder.errors import checks
from morse.core import declarations
from morse.core.exceptions import MorseBuilderError
from morse.mathutils import Euler, Matrix, Vector
from morse.scene import Material, Node, NodeKind, PhysicsType

if TYPE_CHECKING:
    from morse.core.classes.builder_defaults import Visual
    from morse.core.values import Properties, Value

_SHAPE = ("scan_window", "resolution", "layers", "layer_separation", "layer_offset")


class LaserSensorWithArc(SensorCreator):
    """A laser scanner; its component class is `morse.sensors.laserscanner.LaserScanner`."""

    _classpath = "morse.sensors.laserscanner.LaserScanner"

    def create_laser_arc(self) -> None:
        """Validate the properties that determine the rays.

        The rays are created from these properties when the simulation starts, even if this method is not called.

        Raises:
            MorseBuilderError: the properties are not valid for a fan of rays.
        """
        # imported on demand, because importing numpy takes time
        from morse.helpers.fans import fan

        cls = self.component_class()
        defaults = {} if cls is None else {p.name: p.default for p in declarations.properties(cls).values()}
        values = [self.property_value(name) for name in _SHAPE]
        shape = [defaults[name] if value is None else value for name, value in zip(_SHAPE, values, strict=True)]
        try:
            fan(*shape)
        except ValueError as error:
            raise MorseBuilderError(f"{type(self).__name__}.create_laser_arc(): {error}") from None


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


class CompoundSensor(SensorCreator):
    """Several sensors combined; the component class is `morse.sensors.compound.CompoundSensor`."""

    _classpath = "morse.sensors.compound.CompoundSensor"

    def __init__(self, sensors: Iterable[Any], name: str | None = None) -> None:
        """Combine sensors.

        Args:
            sensors: the other sensors.
        """
        super().__init__(name)
        if not isinstance(sensors, Iterable):
            raise TypeError(f"CompoundSensor(sensors) takes a list of sensors, got {checks.shown(sensors)}")
        self.sensors = list(sensors)
        for sensor in self.sensors:
            if not isinstance(sensor, AbstractComponent):
                raise TypeError(f"CompoundSensor(sensors) takes a list of sensors; one item is {checks.shown(sensor)}")

    def _scene_options(self) -> Properties:
        # the names of the other sensors are known only at this point
        self.properties(sensors=",".join(sensor.name for sensor in self.sensors))
        return super()._scene_options()


#: orientation of a camera that looks along the X axis of the robot: its X is to the right, its Y down, its Z forward
MOUNTED = (math.pi / 2, math.pi, math.pi / 2)


#: shortest distance of a point that a camera looks at, m; and the horizontal part of a direction, below which it points
#: straight up or down
_NEAREST, _LEVEL = 1e-6, 1e-9


class CameraCreator(SensorCreator):
    """A camera that looks along the X axis of its parent.

    Its own axes are image axes: X right, Y down, Z forward.
    """

    def __init__(
        self,
        name: str | None = None,
        action: str = ComponentCreator.APPEND_EMPTY,
        blendfile: str | None = None,
        blendobject: str | None = None,
        make_morseable: bool = True,
    ) -> None:
        super().__init__(name, action, blendfile, blendobject, make_morseable)
        if action != self.APPEND_EMPTY:
            return
        self.scene_node.rotation_euler[:] = MOUNTED
        back = Euler(MOUNTED).to_matrix().transposed()
        for body in self.scene_node.children:
            # the body stays upright
            body.location[:] = back @ Vector(body.location)
            body.rotation_euler[:] = (back @ Euler(body.rotation_euler).to_matrix()).to_euler()

    def rotate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> None:
        """Add radians to its direction.

        As in MORSE 1.4, the names of the angles do not match the rotation axes: x rotates the camera to the left about
        the vertical axis, y rotates it up, and z rotates it clockwise about its viewing direction.
        """
        super().rotate(x=y, y=z, z=x)

    def look_at(self, x: float, y: float, z: float) -> None:
        """Turn it towards a point, with the upper edge of the image up. Call it after `translate`.

        Args:
            x, y, z: the point, m, in the frame of what carries the camera: for a robot X forward, Y left, Z up.

        Raises:
            ValueError: the point is that of the camera.
        """
        target = Vector(checks.triple((x, y, z), "camera.look_at(x, y, z)"))
        ahead = target - Vector(self.scene_node.location)
        if ahead.length < _NEAREST:
            raise ValueError(f"camera.look_at takes another point than that of the camera, got {tuple(target)}")
        ahead.normalize()
        # straight up or down, the front of the robot is above the centre of the image, or below it
        has_up = math.hypot(ahead.x, ahead.y) > _LEVEL
        up = Vector((0.0, 0.0, 1.0)) if has_up else Vector((-math.copysign(1.0, ahead.z), 0.0, 0.0))
        right = ahead.cross(up).normalized()
        down = ahead.cross(right)
        self.scene_node.rotation_euler[:] = Matrix((right, down, ahead)).transposed().to_euler()


class _Colors(CameraCreator):
    _classpath = "morse.sensors.video_camera.VideoCamera"


class _Depths(CameraCreator):
    _classpath = "morse.sensors.depth_camera.DepthVideoCamera"


class _Clouds(CameraCreator):
    _classpath = "morse.sensors.depth_camera.DepthCamera"


class VLP16_180(SensorCreator):  # noqa: N801 (its name in MORSE 1.4)
    """Three depth cameras ``cam1``, ``cam2`` and ``cam3`` side by side; 16 rows of each image are used."""

    _classpath = "morse.sensors.vlp16.VLP16_180"
    _ROWS = (1, 17, 34, 51, 68, 85, 102, 120, 137, 154, 171, 188, 205, 222, 239, 255)

    def __init__(self, name: str | None = None) -> None:
        super().__init__(name)
        for number, angle in enumerate((-60.0, 0.0, 60.0), 1):
            camera = _Clouds(f"cam{number}")
            camera.properties(cam_width=512, cam_height=256, cam_focal=27.7, cam_near=0.1, cam_far=100.0)
            camera.properties(keep_list=str(list(self._ROWS)))
            camera.rotate(x=math.radians(angle))
            self.append(camera)
        self.properties(master_camera="cam1")
        self.frequency(10.0)

    def _set_frequency(self, frequency: float) -> None:
        super()._set_frequency(frequency)
        for camera in self.children:
            camera.frequency(frequency)


class Kinect(SensorCreator):
    """A colour camera ``rgb`` and a depth camera ``depth`` side by side, 128 x 128 pixels each."""

    _classpath = "morse.sensors.kinect.Kinect"

    def __init__(self, name: str | None = "Kinect") -> None:
        super().__init__(name)
        self.mark_unexportable()
        casing = Node("KinectMesh", kind=NodeKind.MESH, mesh=solids.cube())
        casing.scale, casing.location = [0.02, 0.1, 0.02], [0.03, 0.0, 0.04]
        casing.materials = [Material(casing.name, (0.05, 0.05, 0.05, 1.0))]
        workspace.current().add(casing)
        workspace.current().attach(self.scene_node, casing)
        self.video_camera, self.depth_camera = (
            self._camera(_Colors, "rgb"),
            self._camera(_Depths, "depth"),
        )
        self.video_camera.translate(0.06, 0.08, 0.04)
        self.depth_camera.translate(0.06, -0.08, 0.04)

    def _camera(self, kind: type[CameraCreator], name: str) -> CameraCreator:
        camera = kind(name)
        camera.properties(cam_width=128, cam_height=128)
        self.append(camera)
        return camera

    def add_stream(self, *args: Value, **kwargs: Value) -> None:
        """Add a stream to both cameras; see `morse.builder.components.interfaces.Interfaces`."""
        self.video_camera.add_stream(*args, **kwargs)
        self.depth_camera.add_stream(*args, **kwargs)

    def add_interface(self, interface: str, **kwargs: object) -> None:
        """Offer the services and stream the data of both cameras."""
        super().add_interface(interface)
        for camera in (self.video_camera, self.depth_camera):
            camera.add_interface(interface, **kwargs)

    def _add_missing_interface(self, interface: str) -> None:
        # the cameras are connected one by one
        super().add_interface(interface)

    def _set_frequency(self, frequency: float) -> None:
        super()._set_frequency(frequency)
        for camera in self.children:
            camera.frequency(frequency)

    def profile(self) -> None:
        """Show the share of time that both cameras use."""
        self.video_camera.profile()
        self.depth_camera.profile()
