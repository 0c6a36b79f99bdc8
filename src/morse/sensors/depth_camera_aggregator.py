"""Merges the point clouds of several depth cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.core.exceptions import MorseRPCTypeError
from morse.core.reports.quoting import nearest, shown
from morse.core.services import service
from morse.helpers.components import add_data, add_kind, add_property
from morse.mathutils.portable import matmul
from morse.sensors.camera_unit import CameraUnit
from morse.sensors.depth_camera import DepthCamera

if TYPE_CHECKING:
    from morse.core.object import Object
    from morse.core.sensor import Pose


class DepthCameraAggregator(CameraUnit):
    """Merges the point clouds of its depth cameras in the frame of one of them, the master."""

    _name = "Depth camera aggregator"
    _short_desc = "Merges the clouds of several depth cameras"
    _builder = BuilderDefaults(frequency=20.0)

    add_data(
        "points",
        np.zeros((0, 3), np.float32),
        "memoryview",
        "Points of the pixels that show a surface, in the frame of the master",
        unit="m",
        frame="optical",
        shape=(None, 3),
        dtype="float32",
    )
    add_data("nb_points", 0, "integer", "Number of points", low=0, follows="points")

    add_property("master_camera", "", "master_camera", "string", "Name of the master; empty for the first camera")

    add_kind("cloud", points="points")

    master_camera: str
    _measured_from: Pose | None = None

    @property
    def image_height(self) -> int:
        """Number of rows: 1."""
        return 1

    @property
    def image_width(self) -> int:
        """Number of points."""
        return int(self.local_data["nb_points"])

    def clouds(self) -> list[DepthCamera]:
        """The depth cameras mounted on it."""
        return [camera for camera in self.cameras() if isinstance(camera, DepthCamera)]

    def master(self) -> DepthCamera:
        """The camera whose frame is used for the cloud.

        Raises:
            IndexError: no depth camera is mounted on it.
        """
        return self._master(self.clouds())

    def frame_owner(self) -> Object | None:
        """See `Object.frame_owner`: the cloud is in the frame of the master camera."""
        return self.master() if self.clouds() else None

    @service
    def set_property(self, name: str, value: object) -> None:
        """Change a property while the simulation runs."""
        before = self.master_camera
        super().set_property(name, value)
        if name == "master_camera" and self.master_camera and not self._named(self.clouds()):
            problem, self.master_camera = self._no_master(), before
            raise MorseRPCTypeError(problem)

    def _named(self, cameras: list[DepthCamera]) -> list[DepthCamera]:
        name = self.master_camera
        return [c for c in cameras if c.name() == name or c.name().endswith(f".{name}")]

    def _no_master(self) -> str:
        camera_names = [camera.name().rpartition(".")[2] for camera in self.clouds()]
        return (
            f"{self.name()}: it has no depth camera {shown(self.master_camera)}, which 'master_camera' names"
            f"{nearest(self.master_camera, camera_names)}"
        )

    def _master(self, cameras: list[DepthCamera]) -> DepthCamera:
        candidates = self._named(cameras) if self.master_camera else cameras
        if not candidates:
            problem = f"{self._no_master()}; the cloud is in the frame of {cameras[0].name()}"
            self.context.complaints.warn(problem, problem)
        return (candidates or cameras)[0]

    def measured_from(self) -> Pose:
        """Return the pose of the master when the clouds were merged."""
        return self._measured_from or super().measured_from()

    def measure(self) -> None:
        """Merge the clouds."""
        super().measure()
        cameras = self.clouds()
        if not cameras:
            return
        position, rotation = self._measured_from = self._master(cameras).bge_object.world_pose()
        to_master = np.reshape(rotation, (3, 3))
        clouds = [np.zeros((0, 3), np.float32)]
        for camera in cameras:
            here, own = camera.bge_object.world_pose()
            if camera.request.shot is not None:
                # rendered in this tick, although the action of the camera comes later
                camera.measure()
            points = camera.local_data["points"].astype(np.float64)
            world_points = matmul(points, np.reshape(own, (3, 3)).T) + (np.array(here) - position)
            clouds.append(matmul(world_points, to_master).astype(np.float32))
        self.local_data["points"] = np.concatenate(clouds)
        self.local_data["nb_points"] = len(self.local_data["points"])
