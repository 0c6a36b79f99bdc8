"""Cameras, whose axes are image axes, not those of the robot."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.assets import solids
from morse.builder import workspace
from morse.builder.creator import ComponentCreator, SensorCreator
from morse.builder.errors import checks
from morse.mathutils import Euler, Matrix, Vector
from morse.scene import Material, Node, NodeKind

if TYPE_CHECKING:
    from morse.core.values import Value


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
