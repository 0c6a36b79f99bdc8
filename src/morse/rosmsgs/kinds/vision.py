"""Scans, point clouds and images."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.rosmsgs.kinds.compression import compressed_outlet
from morse.rosmsgs.kinds.image_forms import encoding_of, form_of
from morse.rosmsgs.outlets import Inlet, Outlet
from morse.rosmsgs.parts import header
from morse.rosmsgs.qos import Qos
from morse.rosmsgs.table import TopicTable, topics

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import RosMessage
    from morse.rosmsgs.kinds.image_forms import Form
    from morse.rosmsgs.table import Carrier

#: constants of sensor_msgs/PointField
_UINT16, _UINT32, _FLOAT32 = 4, 6, 7
#: encodings of images: type of a channel and number of channels (sensor_msgs/image_encodings.hpp)
_ENCODINGS = {
    "rgb8": ("u1", 3), "rgba8": ("u1", 4), "bgr8": ("u1", 3), "bgra8": ("u1", 4), "mono8": ("u1", 1),
    "mono16": ("u2", 1), "16UC1": ("u2", 1), "32FC1": ("f4", 1), "32FC2": ("f4", 2), "32FC3": ("f4", 3),
}  # fmt: skip


#: images that a writer keeps for slow readers: bytes, and numbers of images
_KEPT_BYTES, _LEAST_KEPT, _MOST_KEPT = 64 << 20, 30, 90


class VisionKinds(TopicTable):
    """The kinds scan, cloud, image, and camera_info."""

    @topics("scan")
    def scan(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """From right to left; all rays have the same time."""
        period = 1.0 / bound.component.frequency
        return [Outlet("sensor_msgs/msg/LaserScan", lambda m, f: _scan(m, f, period), by_rows=True)]

    @topics("cloud")
    def cloud(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """With all fields of each point."""
        return [Outlet("sensor_msgs/msg/PointCloud2", _cloud, takes_long=True)]

    @topics("image")
    def image(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """On ``image``, and as the plug-ins of image_transport compress it."""
        form = form_of(stream, bound)
        make = _image if form is None else partial(_image, form=form)
        encoding, unit = encoding_of(stream, bound)
        small = compressed_outlet(encoding, unit, form)
        return [
            Outlet("sensor_msgs/msg/Image", make, "image", _history(bound.component, encoding), takes_long=True),
            *([] if small is None else [small]),
        ]

    @topics("camera_info")
    def camera_info(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """With the stamp and the frame of the image."""
        return [Outlet("sensor_msgs/msg/CameraInfo", _camera_info, "camera_info")]

    @topics("image", direction="IN")
    def take_image(self, stream: Carrier, bound: BoundKind) -> list[Inlet]:
        """Any image publisher can control an array of lamps."""
        return [Inlet("sensor_msgs/msg/Image", _from_image)]


def _history(camera: Any, encoding: str) -> Qos:
    """The images of one to three seconds at 30 Hz: on a busy machine, readers are behind for longer than a second."""
    kind, channels = _ENCODINGS.get(encoding, ("u1", 4))
    size = getattr(camera, "image_width", 0) * getattr(camera, "image_height", 0) * channels * np.dtype(kind).itemsize
    return Qos(history=min(max(_KEPT_BYTES // max(size, 1), _LEAST_KEPT), _MOST_KEPT))


def _scan(message: Message, frame: str, period: float) -> RosMessage:
    first, step, count = message.angle_min, message.angle_increment, message.ranges.shape[-1]
    return {
        "header": header(message, frame),
        "angle_min": first,
        # readers compute the number of rays from the angles: the declared fan may not be a multiple of the step
        "angle_max": first + max(count - 1, 0) * step,
        "angle_increment": step,
        "scan_time": period,
        "range_min": message.range_min,
        "range_max": message.range_max,
        "ranges": message.ranges,
        "intensities": () if message.intensities is None else message.intensities,
    }


def _cloud(message: Message, frame: str) -> RosMessage:
    points = message.points
    height, width = points.shape[:2] if points.ndim == 3 else (1, len(points))
    count = height * width
    columns: list[tuple[str, int, str, Any]] = [(axis, _FLOAT32, "<f4", points[..., i]) for i, axis in enumerate("xyz")]
    if message.intensity is not None:
        columns.append(("intensity", _FLOAT32, "<f4", message.intensity))
    if message.color is not None:
        columns.append(("rgb", _FLOAT32, "<u4", _packed(message.color)))
    if message.ring is not None:
        columns.append(("ring", _UINT16, "<u2", message.ring))
    if message.id is not None:
        columns.append(("id", _UINT32, "<u4", message.id))
    table = np.zeros(count, dtype=[(name, dtype) for name, _, dtype, _ in columns])
    for name, _, _, values in columns:
        table[name] = np.reshape(values, -1)
    offsets = {name: table.dtype.fields[name][1] for name, *_ in columns}
    return {
        "header": header(message, frame),
        "height": height,
        "width": width,
        "fields": [
            {"name": name, "offset": offsets[name], "datatype": kind, "count": 1} for name, kind, _, _ in columns
        ],
        "point_step": table.dtype.itemsize,
        "row_step": table.dtype.itemsize * width,
        "data": table.tobytes(),
        "is_dense": bool(np.isfinite(points).all()),
    }


def _packed(color: Any) -> object:
    """Red, green and blue in the bits of a number, as in rviz."""
    red, green, blue = (color[..., i].astype(np.uint32) for i in range(3))
    return red << 16 | green << 8 | blue


def _image(message: Message, frame: str, form: Form | None = None) -> RosMessage:
    pixels, encoding = message.pixels, message.encoding
    if form is not None:
        pixels, encoding = form(pixels, encoding)
    height, width = pixels.shape[:2]
    if encoding in _ENCODINGS:
        pixels = np.ascontiguousarray(pixels, dtype="<" + _ENCODINGS[encoding][0])
    data = pixels.tobytes()
    return {
        "header": header(message, frame),
        "height": height,
        "width": width,
        "encoding": encoding,
        "step": len(data) // height if height else 0,
        "data": data,
    }


def _from_image(message: RosMessage) -> RosMessage:
    height, width, encoding = message["height"], message["width"], message["encoding"]
    if encoding not in _ENCODINGS:
        raise ValueError(f"the encoding {encoding!r}; known: {', '.join(_ENCODINGS)}")
    kind, channels = _ENCODINGS[encoding]
    dtype = np.dtype((">" if message["is_bigendian"] else "<") + kind)
    row, step, data = width * channels * dtype.itemsize, message["step"], message["data"]
    if step < row or len(data) < step * height or not height or not width:
        raise ValueError(f"{len(data)} bytes for {height} rows of {step} bytes, {width} pixels each")
    rows = np.reshape(data[: step * height], (height, step))[:, :row]
    pixels = np.ascontiguousarray(rows).view(dtype).reshape(height, width, channels)
    if encoding.startswith("bgr"):
        pixels = pixels[..., [2, 1, 0, *range(3, channels)]]
    return {"pixels": pixels.astype(dtype.newbyteorder("="), copy=False)}


def _camera_info(message: Message, frame: str) -> RosMessage:
    k = np.asarray(message.k, dtype=np.float64)
    p = message.p if message.p is not None else np.hstack([k, np.zeros((3, 1))])
    distortion = message.d if len(message.d) else np.zeros(5)
    return {
        "header": header(message, frame),
        "height": message.height,
        "width": message.width,
        "distortion_model": message.model or "plumb_bob",
        "d": distortion,
        "k": k.reshape(-1),
        "r": np.reshape(message.r if message.r is not None else np.eye(3), -1),
        "p": np.reshape(p, -1),
    }
