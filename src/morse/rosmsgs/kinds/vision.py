"""Scans, point clouds, images and recognised objects.

Compressed images are as the plug-ins of image_transport write and read them. Sources: compressed_image_transport and
compressed_depth_image_transport of ROS 2 Jazzy. Both decode with OpenCV, whose colours are blue, green, red: the word
``bgr8`` in the format tells the decoder to exchange them.
"""

from __future__ import annotations

import io
import struct
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from morse.core.exceptions import MorseMiddlewareError
from morse.mathutils.portable import matmul
from morse.rosmsgs.parts import as_json, header, quaternion, xyz
from morse.rosmsgs.table import Inlet, Outlet, Qos, TopicTable, topics

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.core.kinds import BoundKind, Message
    from morse.core.values import DecodedMessage, RosMessage
    from morse.rosmsgs.table import Carrier

    #: pixels and their encoding, converted
    Form = Callable[[Any, str], tuple[Any, str]]


#: order of the channels of an encoding, in pixels of red, green, blue, alpha
_ORDERS = {"rgb8": (0, 1, 2), "rgba8": (0, 1, 2, 3), "bgr8": (2, 1, 0), "bgra8": (2, 1, 0, 3)}
_COLOURS = ("rgb8", "rgba8")
#: luma of red, green and blue (ITU-R BT.601)
_LUMA = (0.299, 0.587, 0.114)
_MILLIMETRE, _FARTHEST = 1000.0, 65535


def form_of(stream: Carrier, bound: BoundKind) -> Form | None:
    """The conversion of the images of a stream; None for the images as they are.

    Raises:
        MorseMiddlewareError: the component has no images for an option of the stream.
    """
    options = stream.kwargs
    encoding, depth16 = options.get("encoding"), options.get("depth16", False)
    if not encoding and not depth16:
        return None
    own, unit = _own(bound)
    if encoding and own not in _COLOURS:
        raise MorseMiddlewareError(
            f"{stream.component_name}: encoding='{encoding}' converts colours, and these images are {own}"
            + ("; for whole millimetres, set depth16=True" if own == "32FC1" and unit == "m" else "")
        )
    if depth16 and (own != "32FC1" or unit != "m"):
        raise MorseMiddlewareError(
            f"{stream.component_name}: depth16=True converts depth in metres, and these images are {own}"
        )
    if depth16:
        return _millimetres
    return lambda pixels, own: (_coloured(pixels, own, str(encoding)), str(encoding))


def encoding_of(stream: Carrier, bound: BoundKind) -> tuple[str, str | None]:
    """The encoding of the images of a stream after their conversion, and the unit of the component's pixels."""
    (own, unit), options = _own(bound), stream.kwargs
    return "16UC1" if options.get("depth16") else str(options.get("encoding") or own), unit


def _own(bound: BoundKind) -> tuple[object, str | None]:
    """The encoding and the unit of the images of a component."""
    words = {slot.name: source.get(bound.component) for slot, source in bound.sources if slot.name != "pixels"}
    return words.get("encoding"), words.get("unit")


def _millimetres(pixels: Any, _encoding: str) -> tuple[object, str]:
    """Depth in mm, 0 where it is not known (REP 118)."""
    depth = np.rint(pixels * _MILLIMETRE)
    valid = (depth >= 0.0) & (depth <= _FARTHEST)  # false for NaN and infinity
    return np.where(valid, depth, 0.0).astype(np.uint16), "16UC1"


def _coloured(pixels: Any, own: str, encoding: str) -> Any:
    if encoding == "mono8":
        return np.rint(matmul(pixels[..., :3], np.array(_LUMA))).astype(np.uint8)
    order = _ORDERS[encoding]
    if len(order) > pixels.shape[-1]:
        opaque = np.full((*pixels.shape[:-1], 1), 255, np.uint8)
        pixels = np.concatenate([pixels, opaque], axis=-1)
    return np.ascontiguousarray(pixels[..., list(order)])


_TYPE = "sensor_msgs/msg/CompressedImage"
#: JPEG quality, 0 to 100
_QUALITY = 85
#: of PNG, 0 to 9: higher levels take several times as long, and save a few per cent
_LEVEL = 1
#: channels that are red, green and blue; one channel is grey
_CHANNELS = {"rgb8": (0, 1, 2), "rgba8": (0, 1, 2), "bgr8": (2, 1, 0), "bgra8": (2, 1, 0)}
#: the header of compressed depth: the method (inverse depth), and the numbers a and b
_DEPTH_HEADER = struct.Struct("<iff")
_INVERSE_DEPTH = 0
#: the largest value of a pixel, and that of the farthest depth; 0 is no depth
_CODE_NEAREST, _CODE_FARTHEST = 65535, 1
#: ratio of the farthest to the nearest depth, at least and at most
_RATIOS = (2.0, 1e4)


def compressed_outlet(encoding: str, unit: str | None, form: Form | None) -> Outlet | None:
    """The topic of the compressed images of an encoding; None if image_transport has no compression for it.

    Args:
        encoding: of the images, after their conversion.
        unit: of the pixels of the component.
        form: the conversion; None for the images as they are.
    """
    if encoding in _CHANNELS or encoding == "mono8":
        make, topic = _jpeg, "image/compressed"
    elif encoding == "16UC1" or (encoding == "32FC1" and unit == "m"):
        make, topic = _depth, "image/compressedDepth"
    else:
        return None
    return Outlet(_TYPE, partial(make, form=form), topic, or_none=True, takes_long=True)


def _jpeg(message: Message, frame: str, form: Form | None) -> RosMessage:
    pixels, encoding = _converted(message, form)
    order = _CHANNELS.get(encoding)
    pixels = np.reshape(pixels, pixels.shape[:2]) if order is None else pixels[..., order]
    suffix = "" if order is None else "bgr8"
    data = _file(pixels, "JPEG", quality=_QUALITY)
    return {"header": header(message, frame), "format": f"{encoding}; jpeg compressed {suffix}", "data": data}


def _depth(message: Message, frame: str, form: Form | None) -> RosMessage:
    pixels, encoding = _converted(message, form)
    pixels, numbers = np.reshape(pixels, pixels.shape[:2]), (0.0, 0.0)
    if encoding == "32FC1":
        pixels, numbers = _inverse(pixels)
    data = _DEPTH_HEADER.pack(_INVERSE_DEPTH, *numbers) + _file(pixels, "PNG", compress_level=_LEVEL)
    return {"header": header(message, frame), "format": f"{encoding}; compressedDepth png", "data": data}


def _converted(message: Message, form: Form | None) -> tuple[Any, str]:
    return (message.pixels, message.encoding) if form is None else form(message.pixels, message.encoding)


def _inverse(depth: NDArray[np.float32]) -> tuple[NDArray[np.uint16], tuple[float, float]]:
    """Depth as whole numbers a / depth + b, and the numbers a and b; 0 where there is no depth.

    The range of the numbers is that of the depths of the image: decoders read a and b in each message.
    """
    valid = np.isfinite(depth) & (depth > 0.0)
    if not valid.any():
        return np.zeros(depth.shape, np.uint16), (1.0, 0.0)
    values = depth[valid].astype(np.float64)
    low, high = _RATIOS
    farthest = float(values.max())
    nearest = min(max(float(values.min()), farthest / high), farthest / low)
    a = (_CODE_NEAREST - _CODE_FARTHEST) / (1.0 / nearest - 1.0 / farthest)
    b = _CODE_FARTHEST - a / farthest
    numbers = np.zeros(depth.shape, np.uint16)
    numbers[valid] = np.clip(np.rint(a / values + b), _CODE_FARTHEST, _CODE_NEAREST)
    return numbers, (a, b)


def _file(pixels: object, kind: str, **options: int) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(np.ascontiguousarray(pixels)).save(file, kind, **options)
    return file.getvalue()


#: constants of visualization_msgs/Marker
_CUBE, _TEXT, _ADD, _DELETE_ALL = 1, 9, 0, 3
#: size of an object with unknown size, m
_SIZE = (0.3, 0.3, 0.3)
_GREEN = {"r": 0.2, "g": 0.9, "b": 0.3, "a": 0.5}
_WHITE = {"r": 1.0, "g": 1.0, "b": 1.0, "a": 1.0}


class DetectingKinds(TopicTable):
    """The kind detections."""

    @topics("detections")
    def detections(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Boxes with names, or JSON if the backend does not have vision_msgs; also markers for viewers."""
        frame = "optical" if getattr(bound.component, "relative", False) else "world"
        text = Outlet("std_msgs/msg/String", lambda m, f: {"data": as_json(list(m.records))})
        return [
            Outlet("vision_msgs/msg/Detection3DArray", _detections, frame=frame, instead=text),
            Outlet("visualization_msgs/msg/MarkerArray", _markers, "markers", frame=frame, or_none=True),
        ]


def _detections(message: Message, frame: str) -> RosMessage:
    head = header(message, frame)
    return {"header": head, "detections": [_detection(head, record) for record in message.records]}


def _detection(head: DecodedMessage, record: DecodedMessage) -> RosMessage:
    pose = _pose(record)
    hypothesis = {"class_id": str(record.get("label", "")), "score": float(record.get("score", 1.0))}
    return {
        "header": head,
        "results": [{"hypothesis": hypothesis, "pose": {"pose": pose}}],
        "bbox": {"center": pose, "size": xyz(record.get("size"))},
        "id": str(record.get("id", "")),
    }


def _pose(record: DecodedMessage) -> RosMessage:
    return {"position": xyz(record.get("position")), "orientation": quaternion(record.get("orientation"))}


def _markers(message: Message, frame: str) -> RosMessage:
    # removes the markers of objects that are no longer visible
    markers: list[RosMessage] = [{"header": header(message, frame), "action": _DELETE_ALL}]
    for number, record in enumerate(message.records):
        size = record.get("size") or _SIZE
        common = {"header": header(message, frame), "id": number, "action": _ADD, "pose": _pose(record)}
        markers.append({**common, "ns": "boxes", "type": _CUBE, "scale": xyz(size), "color": _GREEN})
        text = {"ns": "names", "type": _TEXT, "scale": {"z": 0.2}, "color": _WHITE, "text": str(record.get("id", ""))}
        markers.append({**common, **text})
    return {"markers": markers}


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


def _history(camera: object, encoding: str) -> Qos:
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
    columns: list[tuple[str, int, str, np.ndarray]] = [
        (axis, _FLOAT32, "<f4", points[..., i]) for i, axis in enumerate("xyz")
    ]
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


def _packed(color: np.ndarray) -> np.ndarray:
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


def _from_image(message: DecodedMessage) -> RosMessage:
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
