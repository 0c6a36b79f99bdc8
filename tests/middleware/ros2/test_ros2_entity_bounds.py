"""Bounds, tags and named poses of simulation_interfaces, on a backend with calls of the test."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from desk import Desk
from test_ros2_simulation_interfaces import ALL, NOT_FOUND, OK, UNSUPPORTED, Caller, caller_of, pose, spawn

from morse.scene.body import CollisionShape, ShapeKind
from morse.scene.extent import box_around

FAILED, BOX, HULL, SPHERE = 4, 1, 2, 3
URDF = """<robot name="plate"><link name="base"><inertial><mass value="5"/></inertial>
<collision><geometry><box size="2.0 1.0 0.4"/></geometry></collision></link></robot>"""
SCENE = """
zone = Zone("Charging")
zone.name = "dock"
zone.translate(3.0, 4.0, 0.5)
zone.size = (1.0, 2.0, 0.5)
"""


@pytest.fixture
def call(start: Callable[..., tuple[Any, Desk]], monkeypatch: pytest.MonkeyPatch) -> Caller:
    caller = caller_of(start, monkeypatch, SCENE)
    turned = {"x": 0.0, "y": 0.0, "z": math.sin(math.pi / 4), "w": math.cos(math.pi / 4)}
    where = pose(20.0, 10.0, 5.0)
    where["pose"]["orientation"] = turned
    answer = caller("spawn_entity", **spawn("plate", "", where, resource_string=URDF))
    assert answer["result"]["result"] == OK, answer
    return caller


def points(answer: dict[str, Any]) -> list[list[float]]:
    return [[point[axis] for axis in "xyz"] for point in answer["bounds"]["points"]]


def within(kind: int, *corners: tuple[float, float, float]) -> dict[str, Any]:
    bounds = {"type": kind, "points": [dict(zip("xyz", corner, strict=True)) for corner in corners]}
    return {**ALL, "bounds": bounds}


def test_the_bounds_of_an_entity_are_those_of_its_shapes_in_the_world(call: Caller) -> None:
    call("set_simulation_state", state={"state": 2})
    call("set_entity_state", entity="plate", state=put(20.0, 10.0, 5.0))
    answer = call("get_entity_bounds", entity="plate")
    assert (answer["result"]["result"], answer["bounds"]["type"]) == (OK, BOX)
    upper, lower = np.array(points(answer))
    assert upper - lower == pytest.approx([1.0, 2.0, 0.4], abs=0.01), "turned by a right angle"
    assert (upper + lower)[:2] / 2 == pytest.approx([20.0, 10.0], abs=0.01)
    assert call("get_entity_bounds", entity="ghost")["result"]["result"] == NOT_FOUND


@pytest.mark.parametrize(
    ("filters", "is_in"),
    [
        (within(BOX, (21.0, 11.0, 9.0), (19.0, 9.0, -9.0)), True),
        (within(BOX, (19.0, 9.0, -9.0), (21.0, 11.0, 9.0)), True),
        (within(BOX, (30.0, 11.5, 9.0), (19.0, 10.9, -9.0)), True),
        (within(BOX, (30.0, 11.5, 9.0), (19.0, 11.1, -9.0)), False),
        (within(SPHERE, (22.0, 10.0, 4.9), (1.7, 0.0, 0.0)), True),
        (within(SPHERE, (22.0, 10.0, 4.9), (1.3, 0.0, 0.0)), False),
    ],
)
def test_entities_that_overlap_bounds_are_chosen(call: Caller, filters: dict[str, Any], is_in: bool) -> None:
    call("set_simulation_state", state={"state": 2})
    call("set_entity_state", entity="plate", state=put(20.0, 10.0, 5.0))
    answer = call("get_entities", filters=filters)
    assert answer["result"]["result"] == OK
    assert ("plate" in answer["entities"]) is is_in
    assert "robot" not in answer["entities"]


def put(x: float, y: float, z: float) -> dict[str, Any]:
    rest = {"linear": {"x": 0.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}
    state = {**pose(x, y, z), "twist": rest}
    state["pose"]["orientation"] = {"x": 0.0, "y": 0.0, "z": math.sin(math.pi / 4), "w": math.cos(math.pi / 4)}
    return state


@pytest.mark.parametrize(
    ("filters", "code", "words"),
    [
        (within(HULL, (0, 0, 0), (1, 0, 0), (0, 1, 0)), UNSUPPORTED, "bounds.type"),
        (within(77, (0, 0, 0), (1, 0, 0)), FAILED, "bounds.type"),
        (within(BOX, (0, 0, 0)), FAILED, "bounds.points has 1"),
        (within(BOX, (math.nan, 0, 0), (1, 1, 1)), FAILED, "not finite"),
        (within(SPHERE, (0, 0, 0), (-1, 0, 0)), FAILED, "radius"),
    ],
)
def test_bounds_that_are_no_filter_are_refused(call: Caller, filters: Any, code: int, words: str) -> None:
    answer = call("get_entities", filters=filters)
    assert answer["result"]["result"] == code
    assert words in answer["result"]["error_message"]
    assert answer["entities"] == []


def test_tags_are_set_and_filter(call: Caller) -> None:
    info = {"category": {"category": 3}, "description": "a plate", "tags": ["heavy", "red"]}
    assert call("set_entity_info", entity="plate", info=info)["result"]["result"] == OK
    assert call("get_entity_info", entity="plate")["info"] == info
    robot = {"category": {"category": 1}, "description": "", "tags": ["red"]}
    assert call("set_entity_info", entity="robot", info=robot)["result"]["result"] == OK

    def tagged(mode: int, *tags: str) -> set[str]:
        return set(call("get_entities", filters={**ALL, "tags": {"tags": [*tags], "filter_mode": mode}})["entities"])

    every, some = 1, 0
    assert tagged(some, "heavy", "red") == {"plate", "robot"}
    assert tagged(every, "heavy", "red") == {"plate"}
    assert tagged(some, "green") == tagged(every, "red", "green") == set()
    assert call("get_entities", filters={**ALL, "categories": [{"category": 3}]})["entities"] == ["plate"]
    assert call("delete_entity", entity="plate")["result"]["result"] == OK
    call("spawn_entity", **spawn("plate", "", pose(20.0, 10.0, 5.0), resource_string=URDF))
    assert list(call("get_entity_info", entity="plate")["info"]["tags"]) == [], "another entity of that name"


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"category": {"category": 9}}, "info.category"),
        ({"description": "x" * 10_000}, "info.description"),
        ({"tags": ["x" * 10_000]}, "info.tags"),
        ({"tags": ["x"] * 10_000}, "info.tags"),
    ],
)
def test_notes_have_limits(call: Caller, change: dict[str, Any], field: str) -> None:
    info = {"category": {"category": 0}, "description": "", "tags": [], **change}
    result = call("set_entity_info", entity="plate", info=info)["result"]
    assert result["result"] == FAILED
    assert field in result["error_message"]


def test_zones_are_named_poses(call: Caller) -> None:
    (dock,) = call("get_named_poses", tags={"tags": [], "filter_mode": 0})["poses"]
    assert (dock["name"], dock["tags"]) == ("dock", ["Charging"])
    assert dock["pose"]["position"] == {"x": 3.0, "y": 4.0, "z": 0.5}
    assert call("get_named_poses", tags={"tags": ["Fire"], "filter_mode": 0})["poses"] == []
    answer = call("get_named_pose_bounds", name="dock")
    assert points(answer) == [[4.0, 6.0, 1.0], [2.0, 2.0, 0.0]]
    assert call("get_named_pose_bounds", name="nowhere")["result"]["result"] == NOT_FOUND


@pytest.mark.parametrize(
    ("shape", "half"),
    [
        (CollisionShape(ShapeKind.SPHERE, (0.5,)), (0.5, 0.5, 0.5)),
        (CollisionShape(ShapeKind.CAPSULE, (0.5, 1.0)), (1.5, 0.5, 0.5)),
        (CollisionShape(ShapeKind.CYLINDER, (0.5, 1.0)), (1.0, 0.5, 0.5)),
        (CollisionShape(ShapeKind.ELLIPSOID, (1.0, 2.0, 3.0)), (3.0, 2.0, 1.0)),
        (CollisionShape(ShapeKind.BOX, (1.0, 2.0, 3.0)), (3.0, 2.0, 1.0)),
    ],
)
def test_boxes_of_shapes_that_lie_on_their_side(shape: CollisionShape, half: tuple[float, ...]) -> None:
    to_x = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    low, high = box_around(shape, np.array([10.0, 0.0, 0.0]), to_x)
    assert (high - low) / 2 == pytest.approx(half)
    assert (high + low) / 2 == pytest.approx((10.0, 0.0, 0.0))


def test_the_box_of_a_height_field_reaches_below_height_0() -> None:
    shape = CollisionShape(ShapeKind.HEIGHT_FIELD, (2.0, 3.0, 1.0, 0.5), heights=np.zeros((2, 2)))
    low, high = box_around(shape, np.zeros(3), np.eye(3))
    assert (low.tolist(), high.tolist()) == ([-2.0, -3.0, -0.5], [2.0, 3.0, 1.0])
