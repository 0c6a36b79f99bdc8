"""Data sets of pictures with labelled objects, in the format of COCO (Lin et al. 2014)."""

from __future__ import annotations

import bisect
import json
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from morse.mathutils.portable import matmul
from morse.recording.errors import RecordingError
from morse.recording.fields import COMPONENT, FIELDS
from morse.recording.fields.blocks import block_of
from morse.rosmsgs.cdr import CdrError, decode

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from morse.recording.mcap.reader import Channel, McapFile
    from morse.recording.mcap.records import Message

#: name of the file with the labels, and of the folder with the pictures
LABELS, PICTURES = "annotations.json", "images"
IMAGE, _INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
_IDS = "16UC1"
#: the encodings of pictures: number of bytes of a pixel, and the places of red, green and blue in it
COLORS = {"rgb8": (3, [0, 1, 2]), "rgba8": (4, [0, 1, 2]), "bgr8": (3, [2, 1, 0]), "bgra8": (4, [2, 1, 0])}
#: largest number of annotations of a camera
_MOST = 1_000_000
#: differences of places (m) and of focal lengths (px) that are none
_SAME = 1e-6


class Camera(NamedTuple):
    """A camera of a recording.

    Attributes:
        channel: of its pictures.
        kind: their encoding.
        view: size (px), intrinsic matrix, and the place in the parent's frame: cameras with the same view see the same.
        parent: frame of what it is mounted on.
    """

    channel: Channel
    kind: str
    view: tuple[float, ...]
    parent: str


def cameras_with_labels(file: McapFile) -> dict[str, Channel]:
    """The topics of the ids of segmentation cameras, and the channels of their data fields."""
    fields = {
        channel.metadata.get(COMPONENT, "").replace(".", "/"): channel
        for channel in file.channels.values()
        if channel.topic.startswith(f"{FIELDS}/")
        and channel.metadata.get("morse.class", "").endswith(".SegmentationCamera")
    }
    return {
        channel.topic: fields[name]
        for channel in file.channels.values()
        if channel.type == IMAGE and channel.encoding == "cdr"
        for name in [channel.topic.strip("/").rpartition("/")[0]]
        if name in fields
    }


def write_labels(file: McapFile, topic: str, folder: Path) -> int:
    """Write the pictures of the camera that sees the same as a segmentation camera, with its objects.

    Args:
        file: a recording.
        topic: of `cameras_with_labels`.
        folder: is created, with the pictures and `LABELS`.

    Returns:
        The number of pictures.

    Raises:
        RecordingError: no color camera has the same view, or the recording is damaged.
        OSError: a file cannot be written.
    """
    cameras = _cameras(file)
    ids = next((one for one in cameras if one.channel.topic == topic), None)
    if ids is None or ids.kind != _IDS:
        raise RecordingError(f"it has no images of ids ({_IDS})")
    color = next((one for one in cameras if one.kind in COLORS and _is_same(one, ids)), None)
    if color is None:
        raise RecordingError(
            "no color camera sees the same: add a VideoCamera to the robot with the same place, cam_width, cam_height, "
            "cam_fov and frequency"
        )
    data = _Annotations(_classes(file, cameras_with_labels(file)[topic]))
    for one in file.messages([ids.channel.number]):
        data.add(one.log_time, pixels_of(one, ids))
    (folder / PICTURES).mkdir(parents=True)
    pictures: dict[int, str] = {}
    for one in file.messages([color.channel.number]):
        number = data.numbers.get(one.log_time)
        if number is not None and number not in pictures:
            pictures[number] = f"{number:06d}.png"
            _write(folder / PICTURES / pictures[number], pixels_of(one, color))
    if not pictures:
        raise RecordingError(f"{color.channel.topic} has no picture of the same time: give both the same frequency")
    with (folder / LABELS).open("x", encoding="utf-8") as target:
        json.dump(data.content(pictures, ids), target)
    return len(pictures)


def _is_same(one: Camera, other: Camera) -> bool:
    return (
        one.parent == other.parent
        and len(one.view) == len(other.view)
        and bool(np.allclose(one.view, other.view, rtol=0.0, atol=_SAME))
    )


def decoded(kind: str, one: Message) -> dict[str, Any]:
    """The fields of a message of a type of ROS 2.

    Raises:
        RecordingError: it is damaged.
    """
    try:
        return decode(kind, one.data)
    except (CdrError, ValueError) as error:
        raise RecordingError(f"a message of tick {one.sequence} is damaged: {error}") from None


def _first(file: McapFile, channel: Channel) -> dict[str, Any] | None:
    for one in file.messages([channel.number]):
        return decoded(channel.type, one)
    return None


def _cameras(file: McapFile) -> list[Camera]:
    places = _places(file)
    topics = {channel.topic: channel for channel in file.channels.values() if channel.encoding == "cdr"}
    found = []
    for topic, channel in topics.items():
        info = topics.get(f"{topic.rpartition('/')[0]}/camera_info")
        if channel.type != IMAGE or info is None or info.type != _INFO:
            continue
        image, facts = _first(file, channel), _first(file, info)
        if image is None or facts is None:
            continue
        parent, place = _mounted(str(image["header"]["frame_id"]), places)
        view = (float(image["width"]), float(image["height"]), *map(float, facts["k"]), *place)
        found.append(Camera(channel, str(image["encoding"]), view, parent))
    return found


def _places(file: McapFile) -> dict[str, tuple[str, NDArray[np.float64], NDArray[np.float64]]]:
    """Frame to its parent, position and rotation, of what does not move on its robot."""
    numbers = [channel.number for channel in file.channels.values() if channel.topic == "/tf_static"]
    found = {}
    for one in file.messages(numbers):
        for entry in decoded("tf2_msgs/msg/TFMessage", one)["transforms"]:
            move = entry["transform"]
            x, y, z, w = (float(move["rotation"][axis]) for axis in "xyzw")
            rotation = np.array(
                [
                    [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                    [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                    [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
                ]
            )
            position = np.array([float(move["translation"][axis]) for axis in "xyz"])
            found[str(entry["child_frame_id"])] = (str(entry["header"]["frame_id"]), position, rotation)
    return found


def _mounted(
    frame: str, places: dict[str, tuple[str, NDArray[np.float64], NDArray[np.float64]]]
) -> tuple[str, list[float]]:
    """The frame in which a camera is fixed, and its position and rotation there."""
    position, rotation = np.zeros(3), np.eye(3)
    seen: set[str] = set()
    while frame in places and frame not in seen:
        seen.add(frame)
        frame, offset, turn = places[frame]
        position, rotation = offset + matmul(turn, position), matmul(turn, rotation)
    return frame, [*position.tolist(), *rotation.ravel().tolist()]


def pixels_of(one: Message, camera: Camera) -> NDArray[Any]:
    """(H, W) ids, or (H, W, 3) colors, the top row first.

    Raises:
        RecordingError: the image is damaged, or has another size than the first one.
    """
    image = decoded(IMAGE, one)
    height, width, step = int(image["height"]), int(image["width"]), int(image["step"])
    size, order = COLORS.get(camera.kind, (2, []))
    data = np.asarray(image["data"], np.uint8)
    if (
        not width
        or not height
        or (width, height) != camera.view[:2]
        or step < size * width
        or len(data) != step * height
    ):
        raise RecordingError(f"an image of tick {one.sequence} is damaged, or has another size than the first one")
    rows = np.ascontiguousarray(data.reshape(height, step)[:, : size * width])
    if order:
        return rows.reshape(height, width, size)[:, :, order]
    return rows.view(">u2" if image["is_bigendian"] else "<u2")


def _write(path: Path, pixels: NDArray[Any]) -> None:
    from PIL import Image

    with path.open("xb") as file:
        Image.fromarray(np.ascontiguousarray(pixels)).save(file, "png")


def _classes(file: McapFile, channel: Channel) -> Callable[[int], dict[int, tuple[str, str]]]:
    """A function of the time: id to the name and the class of each object, as the camera last told."""
    times: list[int] = []
    tables: list[dict[int, tuple[str, str]]] = []
    for time, labels in _labels(file, channel):
        if not tables or labels != tables[-1]:
            times.append(time)
            tables.append(labels)

    def at(time: int) -> dict[int, tuple[str, str]]:
        place = bisect.bisect_right(times, time) - 1
        return tables[place] if place >= 0 else {}

    return at


def _labels(file: McapFile, channel: Channel) -> Iterator[tuple[int, dict[int, tuple[str, str]]]]:
    for one in file.messages([channel.number]):
        block = block_of(one, file.path)
        for row in range(len(block)):
            fields = block.row(row)
            try:
                labels: Any = fields.values["labels"]
                table = {int(label["id"]): (str(label["name"]), str(label["class"])) for label in labels}
            except (LookupError, TypeError, ValueError) as error:
                raise RecordingError(f"the labels of tick {fields.tick} are damaged: {error}") from None
            yield fields.time, table


class _Annotations:
    """The objects of all images.

    Attributes:
        numbers: number of each image by its time, ns.
    """

    def __init__(self, classes: Callable[[int], dict[int, tuple[str, str]]]) -> None:
        self.numbers: dict[int, int] = {}
        self._classes = classes
        self._categories: dict[str, int] = {}
        self._annotations: list[dict[str, Any]] = []

    def add(self, time: int, ids: NDArray[np.uint16]) -> None:
        """Add an image of ids, (H, W); objects without a class are background."""
        number = self.numbers.setdefault(time, len(self.numbers) + 1)
        table = self._classes(time)
        for one in np.unique(ids).tolist():
            name, kind = table.get(one, ("", ""))
            if not one or not kind:
                continue
            if len(self._annotations) >= _MOST:
                raise RecordingError(f"it has more than {_MOST:,} annotations: record at a lower frequency")
            category = self._categories.setdefault(kind, len(self._categories) + 1)
            self._annotations.append(
                {
                    "id": len(self._annotations) + 1,
                    "image_id": number,
                    "category_id": category,
                    **_region(ids == one),
                    "iscrowd": 0,
                    "object": {"id": one, "name": name},
                }
            )

    def content(self, pictures: dict[int, str], camera: Camera) -> dict[str, Any]:
        """The content of the file; images without a picture are left out."""
        width, height = (int(size) for size in camera.view[:2])
        return {
            "info": {"description": f"{camera.channel.topic} of a recording of MORSE"},
            "images": [
                {"id": number, "file_name": pictures[number], "width": width, "height": height, "time": time / 1e9}
                for time, number in self.numbers.items()
                if number in pictures
            ],
            "annotations": [one for one in self._annotations if one["image_id"] in pictures],
            "categories": [{"id": number, "name": name} for name, number in self._categories.items()],
        }


def _region(mask: NDArray[np.bool_]) -> dict[str, Any]:
    """A mask as its box x, y, width, height (px), its area, and run lengths by columns, zeros first."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    flat = mask.ravel(order="F")
    edges = np.flatnonzero(np.diff(flat)) + 1
    bounds = np.concatenate(([0], edges, [len(flat)]))
    counts = np.diff(bounds).tolist()
    return {
        "bbox": [
            int(columns[0]), int(rows[0]), int(columns[-1] - columns[0]) + 1, int(rows[-1] - rows[0]) + 1,
        ],
        "area": int(mask.sum()),
        "segmentation": {"size": list(mask.shape), "counts": [0, *counts] if flat[0] else counts},
    }  # fmt: skip
