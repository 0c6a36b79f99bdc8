"""Options of streams for images and scans, and pairs of cameras."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from morse.middleware import registry
from morse.rosmsgs.kinds.vision import form_of
from morse.sensors.kinect import Kinect
from morse.sensors.stereo_unit import StereoUnit

if TYPE_CHECKING:
    from collections.abc import Callable

    from desk import Desk

    from morse.rosmsgs.kinds.vision import Form

SMALL = "cam_width=4, cam_height=2"


class Slot:
    def __init__(self, name: str) -> None:
        self.name = name


class Source:
    def __init__(self, value: Any) -> None:
        self.value = value

    def get(self, component: Any) -> Any:
        return self.value


class Bound:
    component = None

    def __init__(self, encoding: str, unit: str | None) -> None:
        self.sources = [(Slot("encoding"), Source(encoding)), (Slot("unit"), Source(unit))]


class Stream:
    component_name = "robot.eye"

    def __init__(self, **kwargs: Any) -> None:
        self.kwargs = kwargs


def form(own: str, unit: str | None = None, /, **options: Any) -> Form:
    found = form_of(Stream(**options), Bound(own, unit))  # type: ignore[arg-type]
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("encoding", "expected"),
    [
        ("rgb8", [10, 20, 30]),
        ("bgr8", [30, 20, 10]),
        ("rgba8", [10, 20, 30, 40]),
        ("bgra8", [30, 20, 10, 40]),
        ("mono8", 18),  # 0.299 * 10 + 0.587 * 20 + 0.114 * 30 = 18.15 (ITU-R BT.601)
    ],
)
def test_colours_are_converted(encoding: str, expected: Any) -> None:
    pixels = np.array([[[10, 20, 30, 40]]], dtype=np.uint8)
    converted, name = form("rgba8", encoding=encoding)(pixels, "rgba8")
    assert (name, converted.dtype, converted[0, 0].tolist()) == (encoding, np.uint8, expected)


def test_depth_is_whole_millimetres_and_0_where_it_is_unknown() -> None:
    # REP 118: 16UC1 is in mm, 0 is invalid
    depth = np.array([[1.2344, 65.535, 65.54, math.inf, -math.inf, math.nan]], dtype=np.float32)
    converted, name = form("32FC1", "m", depth16=True)(depth, "32FC1")
    assert (name, converted.dtype, converted.tolist()) == ("16UC1", np.uint16, [[1234, 65535, 0, 0, 0, 0]])


def test_options_arrive_in_messages(start: Callable[..., tuple[Any, Desk]]) -> None:
    sim, desk = start(
        f'eye = VideoCamera("eye"); eye.properties({SMALL}); robot.append(eye)\n'
        'eye.add_stream("ros2", encoding="bgr8")\n'
        f'far = DepthVideoCamera("far"); far.properties({SMALL}); far.add_stream("ros2", depth16=True)\n'
        "far.rotate(y=-1.5707963); far.translate(z=2.0); robot.append(far)\n"
        'scan = Hokuyo("scan"); scan.translate(z=0.5); scan.add_stream("ros2", points=True); robot.append(scan)',
        connected="",
    )
    sim.step(6)
    seen = np.asarray(sim.robot.eye.data["image"])
    image = desk.last("/robot/eye/image")
    assert (image.encoding, image.step) == ("bgr8", 12)
    assert image.data.reshape(2, 4, 3)[..., ::-1].tolist() == seen[..., :3].tolist()
    depth = desk.last("/robot/far/image")
    assert (depth.encoding, depth.step) == ("16UC1", 8)
    # the camera looks down on the ground
    height = sim.robot.far.component.bge_object.world_pose()[0][2]
    assert depth.data.view("<u2")[0] == pytest.approx(1000.0 * height, abs=2.0)
    cloud = desk.last("/robot/scan/points")
    assert cloud.header.frame_id == "robot/scan"


@pytest.mark.parametrize(
    ("component", "options", "expected"),
    [
        ("DepthVideoCamera", "encoding='rgb8'", "these images are 32FC1; for whole millimetres, set depth16=True"),
        ("VideoCamera", "depth16=True", "converts depth in metres, and these images are rgba8"),
        ("Pose", "points=True", "is for laser scanners with one layer"),
    ],
)
def test_an_option_for_other_components_is_refused(
    start: Callable[..., tuple[Any, Desk]], component: str, options: str, expected: str
) -> None:
    with pytest.raises(Exception, match=expected):
        start(f'eye = {component}("eye"); eye.add_stream("ros2", {options}); robot.append(eye)', connected="")


def test_the_right_camera_of_a_pair_says_how_far_it_is_from_the_left(start: Callable[..., tuple[Any, Desk]]) -> None:
    sim, desk = start(
        'pair = StereoUnit("pair"); pair.translate(0.1, 0.2, 0.3); pair.rotate(z=0.4); robot.append(pair)\n'
        f'left = VideoCamera("left"); left.translate(y=0.06); left.properties({SMALL}); pair.append(left)\n'
        f'right = VideoCamera("right"); right.translate(y=-0.06); right.properties({SMALL}); pair.append(right)'
    )
    sim.step(6)
    left, right = (desk.last(f"/robot/pair/{name}/camera_info") for name in ("left", "right"))
    assert left.p[3] == 0.0
    # sensor_msgs/CameraInfo: Tx = -fx' * B
    assert right.p[3] == pytest.approx(-right.k[0] * 0.12)
    assert left.p.tolist()[:3] == right.p.tolist()[:3]
    # nothing on the unit moves: its frames are fixed
    fixed = {one.child_frame_id for one in desk.last("/tf_static").transforms}
    moving = {one.child_frame_id for one in desk.last("/tf").transforms}
    assert "robot/pair/left" in fixed - moving
    assert "/robot/pair" not in desk.publishers
    # the cameras on a unit carry the data: no middleware has a stream for the unit itself
    assert all(
        one.stream_of(unit, "OUT") is None for one in registry.installed().values() for unit in (StereoUnit, Kinect)
    )


def test_writers_keep_as_many_images_for_slow_readers_as_fit_into_64_megabytes(
    start: Callable[..., tuple[Any, Desk]],
) -> None:
    sizes = {"small": (4, 2), "usual": (640, 480), "large": (1920, 1080)}
    lines = [
        f'{name} = VideoCamera("{name}"); {name}.properties(cam_width={width}, cam_height={height}); '
        f'{name}.add_stream("ros2", encoding="rgb8"); robot.append({name})\n'
        for name, (width, height) in sizes.items()
    ]
    _, desk = start("".join(lines), connected="")
    kept = {name: desk.publishers[f"/robot/{name}/image"][1].history for name in sizes}
    assert kept["small"] == 90, "three seconds at 30 Hz"
    assert kept["usual"] * 640 * 480 * 3 <= 64 << 20 < (kept["usual"] + 1) * 640 * 480 * 3
    assert kept["large"] == 30, "one second at 30 Hz"
