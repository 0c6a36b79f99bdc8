import base64
import json
from typing import Any

import numpy as np
import pytest
from socket_bench import Bench, Body

from morse.core.declarations import add_data
from morse.core.sensor import Sensor
from morse.mathutils import Matrix
from tests.kit.waiting import wait_until

PIXELS = np.array([[[255, 0, 0, 255], [0, 255, 0, 255], [10, 20, 30, 255]]], dtype=np.uint8)
POINTS = np.array([[1.0, 2.0, 3.0], [-1.5, 0.25, 10.0]], dtype=np.float32)


class Camera(Sensor):
    """A camera with a constant image, one pixel high and three wide."""

    add_data("image", b"", "bytes", "RGBA")
    add_data("points", b"", "bytes", "x, y, z")
    add_data("intrinsic_matrix", None, "mat3<float>", "of the lens")

    image_width = 3
    image_height = 1
    capturing = True

    def default_action(self) -> None:
        self.local_data["image"] = PIXELS.tobytes()
        self.local_data["points"] = POINTS
        self.local_data["intrinsic_matrix"] = Matrix(((2.0, 0.0, 1.5), (0.0, 2.0, 0.5), (0.0, 0.0, 1.0)))


def message(bench: Bench, stream: str) -> dict[str, Any]:
    camera = bench.add(Camera(Body("robot1.camera")), "OUT", stream, port=0)
    client = bench.connect("robot1.camera")
    camera.capturing = False
    bench.tick()
    camera.capturing = True
    bench.tick()
    (line,) = wait_until(client.lines)
    client.close()
    return json.loads(line)  # type: ignore[no-any-return]


def test_an_image_is_its_bytes_in_base64_and_comes_only_while_the_camera_captures(bench: Bench) -> None:
    sent = message(bench, "morse.middleware.sockets.video_camera.VideoPublisher")
    assert list(sent) == ["timestamp", "height", "width", "image", "intrinsic_matrix"]
    assert (sent["height"], sent["width"]) == (1, 3)
    assert base64.b64decode(sent["image"]) == PIXELS.tobytes()
    assert sent["intrinsic_matrix"] == [[2.0, 0.0, 1.5], [0.0, 2.0, 0.5], [0.0, 0.0, 1.0]]
    assert sent["timestamp"] == pytest.approx(1 / 60)


def test_a_grey_image_is_the_brightness_of_its_pixels(bench: Bench) -> None:
    sent = message(bench, "morse.middleware.sockets.video_camera.Video8uPublisher")
    # ITU-R BT.709: 0.2126 R + 0.7152 G + 0.0722 B
    assert list(base64.b64decode(sent["image"])) == [54, 182, 18]


def test_a_cloud_is_its_points_as_float32(bench: Bench) -> None:
    sent = message(bench, "morse.middleware.sockets.depth_camera.DepthCameraPublisher")
    assert list(sent) == ["timestamp", "height", "width", "points", "intrinsic_matrix"]
    points = np.frombuffer(base64.b64decode(sent["points"]), dtype="<f4").reshape(-1, 3)
    np.testing.assert_array_equal(points, POINTS)
