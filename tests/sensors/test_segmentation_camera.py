"""The object in each pixel, and bounding boxes of objects."""

import base64
import io
import json
import math
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from PIL import Image

from morse.core.requests import prepare
from morse.rendering import renderer
from morse.viewer.feeds.sensors import PicturesFeed
from morse.viewer.hub import Wishes

WORLD = """
robot = FakeRobot("robot")
eye = SegmentationCamera("eye")
eye.properties(cam_width=200, cam_height=150, cam_focal=16, cam_far=40{more})
eye.translate(x=1.0, z=1.0)
robot.append(eye)
other = ATRV("other")
other.translate(8, 3, 0)
red = Cube("Red"); red.scale = (0.5, 0.5, 0.5); red.location = (5, 0, 1.5); red.color(1, 0, 0)
red.properties(Object=True, Label="THING", Type="box")
hidden = Cube("Hidden"); hidden.scale = (0.2, 0.2, 0.2); hidden.location = (9, 0, 1.2)
hidden.properties(Object=True, Type="box")
blue = Cube("Blue"); blue.scale = (0.25, 1.0, 0.5); blue.location = (6, -2, 1.0); blue.rotation_euler = (0, 0, 0.5)
blue.properties(Object=True, Type="crate")
env = Environment("empty")
"""


@pytest.fixture
def look(simulate):
    def make(more="", script=WORLD):
        simulation = simulate(script.format(more=more), sockets=False)
        simulation.sleep(0.1)
        return simulation.context.component("robot.eye"), simulation

    return make


def seen(eye):
    return {thing["name"]: thing for thing in eye.local_data["objects"]}


def test_each_pixel_has_the_id_of_its_thing(look):
    eye, _ = look()
    image, classes = eye.local_data["image"], eye.local_data["classes"]
    assert image.shape == classes.shape == (150, 200)
    labels = {row["name"]: row for row in eye.local_data["labels"]}
    # f = 100 px: the front of the red box is 3.5 m ahead and 0.5 m up
    assert image[75 - 10, 100] == labels["THING"]["id"]
    assert classes[75 - 10, 100] == labels["THING"]["class_id"]
    # the sky
    assert image[0, 0] == 0
    assert classes[0, 0] == 0


def test_what_is_behind_something_else_has_a_label_and_no_box(look):
    eye, _ = look()
    assert "Hidden" not in seen(eye)
    assert "Hidden" in {row["name"] for row in eye.local_data["labels"]}


def test_things_of_one_class_share_its_id(look):
    eye, _ = look()
    labels = {row["name"]: row for row in eye.local_data["labels"]}
    assert labels["THING"]["class_id"] == labels["Hidden"]["class_id"] != labels["Blue"]["class_id"]
    assert labels["robot"]["class"] == labels["other"]["class"] == "robot"
    ids = [row["id"] for row in labels.values()]
    assert len(set(ids)) == len(ids)
    assert min(ids) == 1


def test_a_robot_is_one_thing_with_its_wheels(look):
    eye, _ = look()
    other = seen(eye)["other"]
    # its centre is 7 m ahead and 3 m to the left, it is 1.2 m long and 1 m wide at most
    window = eye.local_data["image"][60:100, 100 - 56 : 100 - 31]
    assert (window == other["id"]).sum() == other["pixels"] > 50


def test_the_classes_may_be_given(look):
    eye, _ = look(", class_names='wall, crate, robot'")
    ids = {row["class"]: row["class_id"] for row in eye.local_data["labels"]}
    assert (ids["crate"], ids["robot"], ids["box"]) == (2, 3, 4)


def test_the_flat_box_is_that_of_the_pinhole_formula(look):
    eye, _ = look()
    x0, y0, x1, y1 = seen(eye)["THING"]["box"]
    # its front, 1 m x 1 m, is 3.5 m from the camera: the pixels whose centres it covers
    half = 100 * 0.5 / 3.5
    assert (x0, x1) == (math.ceil(100 - half - 0.5), math.floor(100 + half - 0.5) + 1)
    # from 1 m below to the upper edge: 0 to 1 m above the camera
    assert (y0, y1) == (math.ceil(75 - 2 * half - 0.5), 75)


def test_the_box_holds_all_pixels_and_no_row_too_many(look):
    eye, _ = look()
    image = eye.local_data["image"]
    for thing in eye.local_data["objects"]:
        x0, y0, x1, y1 = thing["box"]
        mask = image == thing["id"]
        assert mask.sum() == thing["pixels"] == mask[y0:y1, x0:x1].sum()
        assert all(edge.any() for edge in (mask[y0], mask[y1 - 1], mask[:, x0], mask[:, x1 - 1]))


def test_the_box_in_space_is_along_the_thing(look):
    eye, _ = look()
    blue = seen(eye)["Blue"]
    assert blue["size"] == pytest.approx([0.5, 2.0, 1.0], abs=1e-6)
    assert blue["position"] == pytest.approx([6, -2, 1], abs=1e-6)
    assert list(blue["orientation"]) == pytest.approx([math.cos(0.25), 0, 0, math.sin(0.25)], abs=1e-6)


def test_relative_boxes_are_in_the_frame_of_a_picture(look):
    eye, _ = look(", relative=True")
    red = seen(eye)["THING"]
    # 4 m ahead, 0.5 m up: X to the right, Y down, Z forward
    assert red["position"] == pytest.approx([0, -0.5, 4.0], abs=1e-5)
    corners = np.stack(np.meshgrid(*[[-0.5, 0.5]] * 3), axis=-1).reshape(-1, 3) + red["position"]
    x = 100 * corners[:, 0] / corners[:, 2] + 100
    assert x.min() - 1 <= red["box"][0]
    assert red["box"][2] <= x.max() + 1


def test_ids_stay_when_things_come_and_go(look):
    eye, simulation = look()
    before = {row["name"]: row["id"] for row in eye.local_data["labels"]}
    names = set(before)
    eye.context.world.game_object("Red").visible = False
    simulation.sleep(0.1)
    assert "THING" not in seen(eye)
    after = {row["name"]: row["id"] for row in eye.local_data["labels"]}
    assert {name: after[name] for name in names & after.keys()} == {name: before[name] for name in names & after.keys()}


def test_small_things_may_be_left_out(look):
    eye, _ = look(", fewest_pixels=800")
    assert all(thing["pixels"] >= 800 for thing in eye.local_data["objects"])
    assert "THING" not in seen(eye) or seen(eye)["THING"]["pixels"] >= 800


def test_the_message_holds_pixels_labels_and_boxes(look):
    from morse.wire.images import image_fields

    eye, _ = look()

    message = json.loads(image_fields(eye, eye.local_data).line())
    pixels = np.frombuffer(base64.b64decode(message["image"]), "<u2").reshape(message["height"], message["width"])
    np.testing.assert_array_equal(pixels, eye.local_data["image"])
    kinds = np.frombuffer(base64.b64decode(message["classes"]), "<u2").reshape(150, 200)
    np.testing.assert_array_equal(kinds, eye.local_data["classes"])
    assert {row["name"] for row in message["labels"]} >= {"THING", "Blue", "robot"}
    (thing,) = [row for row in message["objects"] if row["name"] == "THING"]
    assert thing["box"] == seen(eye)["THING"]["box"]


# -- the image of a semantic camera, which only the live view shows --------------------------------

SCRIPT = """
robot = FakeRobot("robot"); robot.translate(z=10)
eye = SemanticCamera("eye"); eye.properties(cam_width=64, cam_height=64, cam_focal=16); robot.append(eye)
ball = Sphere("Ball"); ball.location = (4, 1, 10); ball.scale = (0.5, 0.5, 0.5)
ball.set_color(0.9, 0.0, 0.0); ball.properties(Object=True, Label="the ball")
env = Environment("empty")
"""


def test_a_page_gets_a_picture_with_the_visible_objects(simulate: Any) -> None:
    simulation = simulate(SCRIPT, sockets=False)
    server = SimpleNamespace(wishes=Wishes(images=frozenset({"robot.eye"})), sent=[])
    server.send = server.sent.append
    feed = PicturesFeed(simulation.context, cast("Any", server))
    feed.update()
    simulation.sleep(0.2)
    feed.update()
    (sent,) = server.sent
    assert sent.meaning == "color"
    (ball,) = sent.sightings
    assert ball.name == "the ball"
    # 90 degrees of view: 32 px for a slope of 1; the ball is at a slope of 1/4 to the left, 1/8 wide on each side
    x0, y0, x1, y1 = ball.box
    assert abs((x0 + x1) / 2 - (32 - 8)) <= 1
    assert abs((y0 + y1) / 2 - 32) <= 1
    assert abs((x1 - x0) - 8) <= 2
    red, green, _ = np.asarray(Image.open(io.BytesIO(sent.payload)))[32, 24]
    assert red > 2 * green
    # nobody looks any more: no colours are rendered
    server.wishes = Wishes()
    feed.update()
    simulation.sleep(0.2)
    assert not simulation.context.component("robot.eye").request.color


def test_the_first_image_has_been_prepared(simulate: Any, monkeypatch: Any) -> None:
    simulation = simulate(SCRIPT, sockets=False)
    prepare(simulation.context.components.values())

    def read_again(*_: object) -> None:
        raise AssertionError("the world is read in a tick")

    monkeypatch.setattr(renderer, "Stage", read_again)
    simulation.sleep(0.2)
    names = [seen["name"] for seen in simulation.context.component("robot.eye").local_data["visible_objects"]]
    assert names == ["the ball"]


# -- objects that one ray finds, as the semantic camera of MORSE 1.4 does --------------------------

SEMANTIC_RAY_SCRIPT = """
def solid(name, location, half, **tags):
    cube = Cube(name); cube.scale = half; cube.location = location
    cube._bpy_object.game.physics_type = "STATIC"
    cube.properties(**tags)
robot = FakeRobot("robot"); robot.translate(z=10)
ray = {{"visibility": "ray"}}
for name, more in (("ray", ray), ("pixels", {{}}), ("all", {{"noocclusion": True, **ray}})):
    eye = SemanticCamera(name); eye.properties(cam_width=64, cam_height=64, cam_focal=16, **more); robot.append(eye)
    {each}
# its origin is behind a post, which hides a tenth of it
solid("Wide", (6, 0, 10), (0.2, 2, 1), Object=True)
solid("Post", (3, 0, 10), (0.1, 0.1, 3))
solid("Near", (2, 1, 10), (0.2, 0.2, 0.2), Object=True)
# its upper end alone is in the field of view, whose half is 45 degrees
solid("Low", (4, -2, 5), (0.2, 0.2, 1.5), Object=True)
solid("Outside", (4, 9, 10), (0.2, 0.2, 0.2), Object=True)
soft = Cube("Soft"); soft.scale = (0.2, 0.2, 0.2); soft.location = (3, 2, 10); soft.properties(Object=True)
env = Environment("empty")
"""


@pytest.fixture
def names(simulate):
    def make(each=""):
        simulation = simulate(SEMANTIC_RAY_SCRIPT.format(each=each), sockets=False)
        simulation.sleep(0.2)
        found = {
            eye: simulation.context.component(f"robot.{eye}").local_data["visible_objects"]
            for eye in ("ray", "pixels", "all")
        }
        return {eye: {seen["name"] for seen in things} for eye, things in found.items()}

    return make


@pytest.mark.parametrize("each", ["", "eye.delay(0.05)"])
def test_a_ray_decides_what_pixels_decide_otherwise(names, each):
    seen = names(each)
    assert seen["pixels"] == {"Wide", "Near", "Low", "Soft"}
    # the ray to the origin of the wide object hits the post; nothing stops it at an object without collision
    assert seen["ray"] == {"Near", "Low"}
    assert seen["all"] == {"Wide", "Near", "Low", "Soft"}
