"""Depth images and point clouds."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from morse.core.declarations import BuilderDefaults
from morse.core.limits import ANGLE
from morse.core.streams.local_data import Later, LocalData
from morse.helpers.components import add_data, add_kind, add_property, add_state
from morse.sensors.camera import CAMERA_INFO, INTRINSIC, Camera

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.core.robot import Robot
    from morse.core.values import Fields
    from morse.core.world import Body
    from morse.rendering import Picture


_VELODYNE_BODY: Fields = {"frequency": 20.0, "model": "velodyne", "part": "VelodyneMesh"}


def _points(camera: DepthCamera) -> NDArray[np.float32]:
    """Return points (N, 3), or (H, W, 3) with NaN for pixels without a point."""
    points = np.asarray(camera.local_data["points"], dtype=np.float32)
    if not camera.keep_resolution or not len(points):
        return points
    whole = points.reshape(-1, camera.image_width, 3)
    return camera.top_first(np.where((whole == 0.0).all(axis=2, keepdims=True), np.float32(np.nan), whole))


def _depths(camera: Camera) -> NDArray[np.float32]:
    """(H, W), the top row first."""
    return camera.top_first(camera.local_data["image"])


class AbstractDepthCamera(Camera):
    """Measures the depth of each pixel; the first row is the bottom row, as in MORSE 1.4."""

    add_property("near_clipping", 1.0, "cam_near", "float", "Near clipping distance", unit="m", low=1e-6, high=1e6)
    add_property("far_clipping", 20.0, "cam_far", "float", "Far clipping distance", unit="m", low=1e-6, high=1e6)
    add_property("retrieve_depth", True, "retrieve_depth", "bool", "Depth is measured; exists for old scripts")
    add_property("vertical_flip", False, "Vertical_Flip", "bool", "The first row of the image is the top row")
    add_property(
        "depth_noise",
        0.0,
        "depth_noise",
        "float",
        "Standard deviation of the depth at 1 m, in m; it grows with the square of the depth",
        low=0.0,
        high=1e3,
    )

    add_state("_random", np.random.Generator, "Noise of the pixels")

    color = False
    uses = ("depth",)
    depth_noise: float

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self._random = self.context.random(f"{self.name()}/depth")

    def depth_of(self, picture: Picture) -> NDArray[np.float32]:
        """Return the depths (H, W) with noise, between the near and the far plane; 0 for pixels without a surface."""
        if not self.depth_noise:
            return picture.depth
        return noisy_depths(picture.depth, self._random, self.depth_noise, self.lens.near, self.lens.far)


def noisy_depths(
    depth: NDArray[np.float32], random: np.random.Generator, noise: float, near: float, far: float
) -> NDArray[np.float32]:
    """Return depths (H, W) with noise, between the near and the far plane, m; 0 for pixels without a surface.

    The error of a disparity is the same at all depths. The error of the depth therefore grows with the square of the
    depth. K. Khoshelham and S. O. Elberink (Accuracy and Resolution of Kinect Depth Data for Indoor Mapping
    Applications, 2012) measured about 1.4 mm at 1 m.

    Args:
        noise: standard deviation of the depth at 1 m, in m.
    """
    errors = random.standard_normal(depth.shape, np.float32) * np.float32(noise)
    noisy = np.clip(depth + errors * depth * depth, np.float32(near), np.float32(far))
    return np.where(depth > 0.0, noisy, np.float32(0.0))


class DepthCamera(AbstractDepthCamera):
    """Captures a point cloud: X right, Y down, Z forward."""

    _name = "Depth (XYZ) camera"
    _short_desc = "A camera capturing 3D points cloud"

    add_data(
        "points",
        np.zeros((0, 3), np.float32),
        "memoryview",
        "Points of the pixels that show a surface",
        unit="m",
        frame="optical",
        shape=(None, 3),
        dtype="float32",
    )
    add_data("nb_points", 0, "integer", "Number of points", low=0, follows="points")
    add_data("intrinsic_matrix", **INTRINSIC)

    add_property(
        "keep_list", None, "keep_list", "string", "Rows that are used, '[1, 17, 34]'; None for all", allow=("none",)
    )
    add_property(
        "keep_resolution",
        False,
        "keep_resolution",
        "bool",
        "A point for each pixel, (0, 0, 0) for pixels without a surface",
    )

    add_kind("cloud", points=_points)
    add_kind("camera_info", **CAMERA_INFO)

    uses = ("depth",)
    keep_list: str | None
    keep_resolution: bool

    def __init__(self, obj: Body, parent: Robot | None = None) -> None:
        super().__init__(obj, parent)
        self.local_data = LocalData(self.local_data)

    def check_properties(self) -> None:
        """Raise `ValueError` if ``keep_list`` is not a list of rows; warn about rows that the image does not have."""
        rows, height = self._rows_kept(), self.image_height
        if rows and rows[-1] >= height:
            text = f"{self.name()}: keep_list contains the row {rows[-1]}; the image has the rows 0 to {height - 1}"
            self.context.complaints.warn(text, text)

    def _rows_kept(self) -> list[int] | None:
        return rows_kept(None if self.keep_list is None else str(self.keep_list))

    def take(self, picture: Picture) -> None:
        """Store the points of the pixels that show a surface."""
        depth, lens = self.depth_of(picture), self.lens
        rows = self._rows_kept()
        is_surface = depth > 0.0
        if rows is not None:
            mask = np.zeros(len(depth), bool)
            mask[[row for row in rows if row < len(mask)]] = True
            is_surface &= mask[:, None]
        flip, whole = self.vertical_flip, self.keep_resolution

        def points() -> NDArray[np.float32]:
            coordinates = lens.rays() * np.where(is_surface, depth, np.float32(0.0))[..., None] + np.float32(0.0)
            if not flip:
                coordinates = coordinates[::-1]
            if whole:
                return np.ascontiguousarray(coordinates.reshape(-1, 3))
            return np.asarray(coordinates[is_surface if flip else is_surface[::-1]])

        self.local_data["points"] = Later(points)
        self.local_data["nb_points"] = depth.size if whole else int(np.count_nonzero(is_surface))


class DepthCameraRotationZ(DepthCamera):
    """A depth camera that rotates to the left about its vertical axis by one step after each image."""

    _name = "Velodyne"
    _short_desc = "Rotating depth camera"
    _builder = BuilderDefaults(properties={"cam_focal": 35.0}, **_VELODYNE_BODY)
    # the step is the angle of view: 2 atan(32 mm / 2 / 35 mm)
    _products = (
        BuilderDefaults(
            "Velodyne",
            properties={"cam_focal": 35.0, "rotation": 0.8578},
            doc="A depth camera that rotates by its angle of view after each image.",
            **_VELODYNE_BODY,
        ),
        BuilderDefaults(
            "VelodyneZB",
            properties={"cam_focal": 35.0, "rotation": 0.8578},
            doc="The same as Velodyne.",
            **_VELODYNE_BODY,
        ),
    )

    add_property("_rotation", 0.01745, "rotation", "float", "Step to the left after each image", **ANGLE)

    _rotation: float

    def exposed(self) -> None:
        """Rotate."""
        # Y is down
        self.bge_object.applyRotation((0.0, -self._rotation, 0.0), True)


class DepthVideoCamera(AbstractDepthCamera):
    """Captures a depth image."""

    _name = "Depth camera"
    _short_desc = "A camera capturing depth"

    add_data(
        "image",
        np.zeros((0, 0), np.float32),
        "buffer",
        "Depth along the axis; inf without a surface",
        unit="m",
        frame="optical",
        shape=(None, None),
        dtype="float32",
        low=0.0,
        allow=("inf", "-inf"),
    )

    add_data("intrinsic_matrix", **INTRINSIC)

    add_kind("image", pixels=_depths, encoding="32FC1", unit="m")
    add_kind("camera_info", **CAMERA_INFO)

    uses = ("depth",)

    def take(self, picture: Picture) -> None:
        """Store the depths, which are infinite beyond the far plane."""
        depth = self.depth_of(picture)
        self.local_data["image"] = self.ordered(np.where(depth > 0.0, depth, np.float32(np.inf)))


class RawImage(AbstractDepthCamera):
    """Captures the Z buffer as in OpenGL: 0 at the near plane, 1 at the far plane and beyond."""

    _name = "Raw depth camera"
    _short_desc = "A camera capturing the raw z-buffer"
    _builder = replace(Camera._builder, properties={"cam_focal": 35.0, "retrieve_zbuffer": True})

    add_data(
        "image",
        np.zeros((0, 0), np.float32),
        "buffer",
        "Z buffer, 0 to 1",
        frame="optical",
        shape=(None, None),
        dtype="float32",
        low=0.0,
        high=1.0,
    )

    add_data("intrinsic_matrix", **INTRINSIC)

    add_kind("image", pixels=_depths, encoding="32FC1", unit="1")
    add_kind("camera_info", **CAMERA_INFO)

    uses = ("depth",)

    def take(self, picture: Picture) -> None:
        """Convert the depths into Z buffer values."""
        near, far = self.lens.near, self.lens.far
        is_surface = self.depth_of(picture)
        depth = np.where(is_surface > 0.0, is_surface.astype(np.float64), far)
        buffer = np.clip(far * (depth - near) / (depth * (far - near)), 0.0, 1.0)
        self.local_data["image"] = self.ordered(buffer.astype(np.float32))


@lru_cache(maxsize=64)
def rows_kept(text: str | None) -> list[int] | None:
    """Return the rows in ``keep_list``, counted from the top; None for all.

    Raises:
        ValueError: the text is not a list of non-negative integers.
    """
    if text is None or not text.strip():
        return None
    words = text.strip().strip("[]()").replace(",", " ").split()
    if not all(word.isdecimal() for word in words):
        raise ValueError(f"keep_list lists rows of the image, such as '[1, 17, 34]', got {text!r:.80}")
    return sorted({int(word) for word in words})
