"""Camera images, sent to pages."""

import io
import zlib
from typing import Any, cast

import numpy as np
import pytest
from PIL import Image

from morse.core.image_colors import FARTHEST_LEVEL, as_pixels, depth_levels
from morse.sensors.thermal_camera import ThermalCamera
from morse.viewer.feeds.sensors import PicturesFeed, sightings
from morse.viewer.hub import Wishes
from morse.viewer.view_messages import Sighting


class Camera:
    vertical_flip = True

    def __init__(self, image: Any) -> None:
        self.local_data = {"timestamp": 1.5, "image": image}


class Server:
    def __init__(self) -> None:
        self.wishes = Wishes()
        self.sent: list[Any] = []

    def send(self, message: Any) -> None:
        self.sent.append(message)


class Context:
    def __init__(self, **components: Any) -> None:
        self.components = components


def colours() -> np.ndarray:
    image = np.zeros((24, 32, 4), np.uint8)
    image[:12] = (250, 10, 10, 255)
    image[12:] = (10, 10, 250, 255)
    return image


def feed(camera: Any) -> tuple[PicturesFeed, Server]:
    server = Server()
    return PicturesFeed(cast("Any", Context(eye=camera)), cast("Any", server)), server


def test_a_picture_is_sent_once_to_pages_that_want_it() -> None:
    camera = Camera(colours())
    pictures, server = feed(camera)
    pictures.update()
    assert server.sent == []
    server.wishes = Wishes(images=frozenset({"eye", "nobody"}))
    pictures.update()
    pictures.update()
    (sent,) = server.sent
    assert (sent.camera, sent.width, sent.height, sent.mime, sent.time) == ("eye", 32, 24, "image/jpeg", 1.5)
    seen = np.asarray(Image.open(io.BytesIO(sent.payload)))
    assert seen[4, 16].tolist() == pytest.approx([250, 10, 10], abs=12)
    assert seen[20, 16].tolist() == pytest.approx([10, 10, 250], abs=12)
    camera.local_data["image"] = colours()
    pictures.update()
    assert len(server.sent) == 2


def test_a_picture_whose_bottom_row_is_first_is_turned() -> None:
    camera = Camera(colours()[::-1])
    camera.vertical_flip = False
    pictures, server = feed(camera)
    server.wishes = Wishes(images=frozenset({"eye"}))
    pictures.update()
    seen = np.asarray(Image.open(io.BytesIO(server.sent[0].payload)))
    assert seen[4, 16, 0] > 200


def test_distances_are_bright_where_they_are_near() -> None:
    pixels = as_pixels(np.array([[1.0, 2.0], [3.0, np.inf]], np.float32))
    # the farthest depth is not the black of no depth
    assert pixels.tolist() == [[255, 143], [FARTHEST_LEVEL, 0]]
    assert as_pixels(np.full((2, 2), np.inf, np.float32)).max() == 0


@pytest.mark.parametrize(
    "image",
    [
        None,
        b"bytes",
        np.zeros((0, 0, 4), np.uint8),
        np.zeros(5),
        np.zeros((4, 4, 7)),
        np.zeros((4, 4, 2), np.uint8),
        np.array([["a"]]),
    ],
)
def test_what_is_no_picture_is_not_sent(image: Any) -> None:
    pictures, server = feed(Camera(image))
    server.wishes = Wishes(images=frozenset({"eye"}))
    pictures.update()
    assert server.sent == []


def test_ids_have_a_colour_each_and_nothing_is_black():
    ids = np.arange(40, dtype=np.uint16).reshape(5, 8)
    colors = as_pixels(ids)
    assert colors.shape == (5, 8, 3)
    assert (colors[0, 0] == 0).all()
    assert len({tuple(color) for color in colors.reshape(-1, 3).tolist()}) == 40
    # the colour of an id does not depend on the other visible objects
    np.testing.assert_array_equal(as_pixels(ids[:1, :4]), colors[:1, :4])


def test_ids_are_sent_as_they_are_with_what_was_recognised() -> None:
    ids = np.array([[0, 7], [300, 65535]], np.uint16)
    camera = Camera(ids[::-1])
    camera.vertical_flip = False
    camera.local_data["objects"] = [{"id": 300, "name": "crate\u2603", "class": "box", "box": [0, 1, 1, 2]}]
    pictures, server = feed(camera)
    server.wishes = Wishes(images=frozenset({"eye"}))
    pictures.update()
    (sent,) = server.sent
    assert (sent.mime, sent.meaning, sent.width, sent.height) == ("image/x-u16", "ids", 2, 2)
    assert np.frombuffer(zlib.decompress(sent.payload), "<u2").tolist() == [0, 7, 300, 65535]
    assert sent.sightings == [Sighting(300, "crate\u2603", "box", (0.0, 1.0, 1.0, 2.0))]


@pytest.mark.parametrize(
    "objects",
    [
        None,
        "text",
        [None, 7, "text"],
        [{}, {"box": None}, {"box": [1, 2]}, {"box": ["a", 0, 1, 1]}],
        [{"box": [0, 0, np.inf, 1]}, {"box": [0, 0, np.nan, 1]}, {"id": "x", "box": [0, 0, 1, 1]}],
    ],
)
def test_objects_without_a_box_are_left_out(objects: Any) -> None:
    assert list(sightings(objects)) == []


def test_depths_are_sent_with_their_range() -> None:
    depth = np.full((16, 32), 2.0, np.float32)
    depth[:, 8:16], depth[:, 16:24], depth[:, 24:] = 4.0, 6.0, np.inf
    pictures, server = feed(Camera(depth))
    server.wishes = Wishes(images=frozenset({"eye"}))
    pictures.update()
    (sent,) = server.sent
    assert (sent.mime, sent.meaning, sent.low, sent.high) == ("image/jpeg", "depth", 2.0, 6.0)
    grey = np.asarray(Image.open(io.BytesIO(sent.payload)), int)[8, [4, 12, 20, 28]]
    middle = (255 + FARTHEST_LEVEL) / 2
    assert grey[:3].tolist() == pytest.approx([255, middle, FARTHEST_LEVEL], abs=4)
    assert grey[3] < FARTHEST_LEVEL / 2


def test_the_unit_tells_temperatures_from_depths() -> None:
    class Thermal(Camera, ThermalCamera):
        def __init__(self, image: Any) -> None:
            Camera.__init__(self, image)

    pictures, server = feed(Thermal(np.array([[15.0, 36.5]], np.float32)))
    server.wishes = Wishes(images=frozenset({"eye"}))
    pictures.update()
    (sent,) = server.sent
    assert (sent.meaning, sent.low, sent.high, sent.unit) == ("temperature", 15.0, 36.5, "°C")


def test_depths_of_any_kind_have_levels() -> None:
    assert not depth_levels(np.full((2, 2), np.nan)).grey.any()
    assert depth_levels(np.full((2, 2), 3.0)).grey.tolist() == [[255, 255], [255, 255]]
    assert depth_levels(np.array([[-5, 5]], np.int16)).grey.tolist() == [[255, FARTHEST_LEVEL]]
    levels = depth_levels(np.array([[0.0, -np.inf], [1.0, np.inf]], np.float32))
    assert levels.grey.tolist() == [[255, 0], [FARTHEST_LEVEL, 0]]


def test_vectors_have_colours_by_their_directions():
    flow = np.zeros((2, 3, 2), np.float32)
    flow[0, 0], flow[0, 1], flow[1, 0], flow[1, 1] = (4, 0), (-4, 0), (2, 0), (np.nan, 0)
    colors = as_pixels(flow).astype(int)
    assert colors.shape == (2, 3, 3)
    assert colors[0, 2].tolist() == [255, 255, 255]
    assert colors[1, 1].tolist() == [0, 0, 0]
    # to the right is red, to the left is not
    assert colors[0, 0, 0] == 255
    assert colors[0, 0, 1:].max() < 80
    assert colors[0, 1, 0] == 0
    assert colors[1, 0, 1] > colors[0, 0, 1]


def test_rounding_errors_of_a_scene_at_rest_are_white():
    flow = np.random.default_rng(1).normal(0.0, 1e-5, (4, 4, 2)).astype(np.float32)
    assert (as_pixels(flow) == 255).all()


def test_vectors_that_are_not_numbers_are_black():
    assert not as_pixels(np.full((2, 2, 2), np.nan, np.float32)).any()


def test_normals_have_their_coordinates_as_colours():
    normals = np.zeros((1, 4, 3), np.float32)
    normals[0, 1:] = (0, 0, -1), (1, 0, 0), (0, -1, 0)
    assert as_pixels(normals)[0].tolist() == [[0, 0, 0], [128, 128, 255], [255, 128, 128], [128, 255, 128]]
