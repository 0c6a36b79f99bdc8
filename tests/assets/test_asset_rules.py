"""From settings of model files to bodies, and from loose objects to one component."""

import itertools
from collections.abc import Sequence
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.assets.body_settings import SETTINGS, settle
from morse.assets.errors import AssetError
from morse.assets.rules import gather_under_root, resolve_auto
from morse.scene import BodySettings, Bounds, Library, Mesh, Node, NodeKind, PhysicsType

AUTO, RIGID, STATIC, NONE = (
    PhysicsType.AUTO, PhysicsType.RIGID_BODY, PhysicsType.STATIC, PhysicsType.NO_COLLISION,
)  # fmt: skip
RIGID_BODY = {"type": RIGID, "bounds": Bounds.BOX, "mass": 5.0, "friction": 0.25}
GAME = {"type": STATIC, "bounds": Bounds.SPHERE, "mass": 7.0, "radius": 3.0, "ghost": True}


def mesh() -> Mesh:
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype=np.float32)
    return Mesh("mesh", triangle, np.array([[0, 1, 2]], dtype=np.int32), np.zeros(1, dtype=np.int32))


def solid(name: str, kind: PhysicsType = AUTO, **settings: object) -> Node:
    return Node(name, NodeKind.MESH, mesh=mesh(), body=BodySettings(type=kind, **settings), source_name=name)


def empty(name: str, kind: PhysicsType = AUTO, **settings: object) -> Node:
    return Node(name, body=BodySettings(type=kind, **settings), source_name=name)


def tree(root: Node, *children: Node) -> Node:
    for child in children:
        root.attach(child)
    return root


def types(*nodes: Node) -> list[PhysicsType]:
    return [node.body.type for node in nodes]


# settings ----------------------------------------------------------------------------------------


def test_custom_properties_beat_rigid_bodies_and_these_beat_game_settings() -> None:
    settled = settle("box", {"mass": 9, "collision": "capsule", "Label": "box"}, RIGID_BODY, GAME)
    body = settled.body
    assert (body.type, body.bounds, body.mass) == (RIGID, Bounds.CAPSULE, 9)
    assert (body.friction, body.radius, body.ghost) == (0.25, 3.0, True)
    assert settled.properties == {"Label": "box"}
    assert settled.warnings == []


def test_without_settings_the_type_is_left_open() -> None:
    settled = settle("box", {"Label": "box"})
    assert settled.body == BodySettings(type=AUTO)
    assert settled.shapes is None
    assert settled.visible


def test_settings_are_no_properties_of_the_node() -> None:
    properties = {
        "physics_type": "STATIC", "collision": "box", "compound": 1, "mass": 1.0, "friction": 1.0, "restitution": 0.5,
        "linear_damping": 0.5, "angular_damping": 0.5, "radius": 2.0, "ghost": 0, "actor": 0, "visible": 0,
    }  # fmt: skip
    assert properties.keys() == SETTINGS
    settled = settle("box", properties)
    assert settled.properties == {}
    assert settled.body == BodySettings(
        STATIC, Bounds.BOX, True, 1.0, 2.0, 1.0, 0.5, 0.5, 0.5, ghost=False, actor=False
    )
    assert not settled.visible


@pytest.mark.parametrize(
    ("text", "bounds"),
    [
        ("box", Bounds.BOX),
        ("sphere", Bounds.SPHERE),
        ("cylinder", Bounds.CYLINDER),
        ("cone", Bounds.CONE),
        ("capsule", Bounds.CAPSULE),
        ("convex", Bounds.CONVEX_HULL),
        ("mesh", Bounds.TRIANGLE_MESH),
        ("Box", Bounds.BOX),
    ],
)
def test_collision_names_a_shape(text: str, bounds: Bounds) -> None:
    settled = settle("box", {"collision": text})
    assert (settled.body.bounds, settled.body.type, settled.shapes) == (bounds, AUTO, None)


def test_collision_none_takes_the_shape_away() -> None:
    assert settle("box", {"collision": "none"}).body.type is NONE
    moving = settle("box", {"collision": "none", "physics_type": "RIGID_BODY"}, None, GAME)
    assert (moving.body.type, moving.body.bounds, moving.shapes) == (RIGID, None, [])


def test_what_has_a_mass_moves() -> None:
    body = settle("box", {"mass": 2}).body
    assert (body.type, body.mass, body.compound) == (RIGID, 2, True)
    assert settle("box", {"mass": 2}, None, GAME).body.type is STATIC


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("physics_type", "RIGID_BODDY", "did you mean 'RIGID_BODY'?"),
        ("physics_type", "AUTO", "expected one of NO_COLLISION"),
        ("physics_type", 3, "expected one of NO_COLLISION"),
        ("collision", "boks", "did you mean 'box'?"),
        ("mass", -1.0, "expected a number from 1e-09"),
        ("mass", 0, "expected a number"),
        ("mass", "heavy", "expected a number"),
        ("mass", float("nan"), "expected a number"),
        ("restitution", 2, "expected a number from 0 to 1"),
        ("ghost", "yes", "expected 0 or 1"),
        ("compound", 2, "expected 0 or 1"),
        ("actor", [1], "expected 0 or 1"),
    ],
)
def test_settings_without_sense_are_ignored_with_a_word(key: str, value: object, expected: str) -> None:
    settled = settle("crate", {key: value}, None, {"type": STATIC})
    assert settled.body == BodySettings(type=STATIC)
    (warning,) = settled.warnings
    assert "'crate'" in warning
    assert key in warning
    assert expected in warning


@given(
    st.dictionaries(
        st.sampled_from(sorted(SETTINGS)),
        st.one_of(
            st.text(max_size=5),
            st.floats(),
            st.integers(),
            st.booleans(),
            st.lists(st.integers(), max_size=3),
            st.none(),
        ),
    )
)
def test_any_values_give_a_sound_body(properties: dict[str, object]) -> None:
    settled = settle("thing", properties)
    body = settled.body
    assert 0 < body.mass <= 1e9
    assert 0 < body.radius <= 1e6
    assert body.friction is None or body.friction >= 0
    assert body.restitution is None or 0 <= body.restitution <= 1
    assert isinstance(body.type, PhysicsType)
    assert settled.properties == {}


# undecided nodes ---------------------------------------------------------------------------------


def test_an_environment_stands_still() -> None:
    wall, lamp, marker, ball = solid("wall"), Node("lamp", NodeKind.LIGHT), empty("marker"), solid("ball", RIGID)
    lamp.body.type = marker.body.type = AUTO
    resolve_auto([wall, lamp, marker, ball], role="environment")
    assert types(wall, lamp, marker, ball) == [STATIC, NONE, NONE, RIGID]


@pytest.mark.parametrize("role", ["component", "prop"])
def test_a_model_without_settings_is_one_rigid_body(role: str) -> None:
    root, body, wheel, sensor = empty("robot"), solid("body"), solid("wheel"), empty("sensor")
    tree(root, body, sensor)
    tree(body, wheel)
    resolve_auto([root], role=role)
    assert types(root, body, wheel, sensor) == [RIGID, RIGID, RIGID, NONE]
    assert root.body.compound


@pytest.mark.parametrize("role", ["component", "prop", "environment"])
def test_beside_settings_the_rest_is_decoration(role: str) -> None:
    root, box, skin = empty("robot", RIGID, compound=True), solid("box", RIGID, bounds=Bounds.BOX), solid("skin")
    resolve_auto([tree(root, box, skin)], role=role)
    assert types(root, box, skin) == [RIGID, RIGID, NONE]


def test_outlines_without_a_type_are_the_shapes() -> None:
    root, outline, skin = empty("robot"), solid("outline", bounds=Bounds.BOX), solid("skin")
    resolve_auto([tree(root, outline, skin)], role="component")
    assert types(root, outline, skin) == [RIGID, RIGID, NONE]


def test_a_moving_body_without_a_shape_takes_those_below_it() -> None:
    root, skin = empty("crate", RIGID, mass=5.0), solid("skin")
    resolve_auto([tree(root, skin)], role="prop")
    assert types(root, skin) == [RIGID, RIGID]


def test_a_moving_mesh_is_its_own_shape() -> None:
    root, sticker = solid("crate", RIGID), solid("sticker")
    resolve_auto([tree(root, sticker)], role="environment")
    assert types(root, sticker) == [RIGID, NONE]


@given(
    kinds=st.lists(st.sampled_from([AUTO, RIGID, STATIC, NONE]), min_size=1, max_size=8),
    shapes=st.lists(st.booleans(), min_size=8, max_size=8),
    parents=st.lists(st.integers(0, 7), min_size=8, max_size=8),
    role=st.sampled_from(["environment", "component", "prop"]),
)
def test_nothing_stays_undecided(
    kinds: Sequence[PhysicsType], shapes: list[bool], parents: list[int], role: str
) -> None:
    nodes = [
        (solid if shaped else empty)(f"n{k}", kind) for k, (kind, shaped) in enumerate(zip(kinds, shapes, strict=False))
    ]
    for number, node in enumerate(nodes[1:], 1):
        nodes[parents[number] % number].attach(node)
    resolve_auto([nodes[0]], role=role)
    for node, kind in zip(nodes, kinds, strict=True):
        assert node.body.type is (kind if kind is not AUTO else node.body.type)
        assert node.body.type is not AUTO


# loose objects -----------------------------------------------------------------------------------


def library(*roots: Node, path: str = "models/robot.blend", outside: Sequence[str] = ()) -> Library:
    return Library(path, list(roots), outside_scene=set(outside))


def test_the_object_named_like_the_file_is_the_root() -> None:
    first, robot = tree(empty("first"), solid("part")), solid("Robot")
    assert gather_under_root(library(first, robot)) is robot
    assert robot.children == [first]


@pytest.mark.parametrize(
    ("roots", "expected"),
    [
        ([Node("lamp", NodeKind.LIGHT), solid("a"), tree(solid("b"), solid("c"))], "b"),
        ([solid("a"), solid("b", RIGID)], "b"),
        ([solid("a"), empty("b")], "b"),
        ([Node("camera", NodeKind.CAMERA), solid("a"), solid("b")], "a"),
    ],
)
def test_otherwise_the_most_likely_object_is_the_root(roots: list[Node], expected: str) -> None:
    root = gather_under_root(library(*roots))
    assert root.name == expected
    assert [node.kind for node in root.walk() if node.kind in (NodeKind.LIGHT, NodeKind.CAMERA)] == []


def test_loose_parts_stay_where_they_are() -> None:
    robot, eye = tree(empty("robot"), solid("head")), solid("eye")
    robot.location, robot.rotation_euler, robot.scale = [1, 2, 3], [0, 0, pi / 2], [2, 2, 2]
    eye.location, eye.rotation_euler = [4, 5, 6], [0.1, 0.2, 0.3]
    before = [list(row) for row in eye.world_matrix()]
    made = gather_under_root(library(robot, eye))
    assert eye.parent is made
    for row, known in zip(eye.world_matrix(), before, strict=True):
        assert list(row) == pytest.approx(known, abs=1e-9)
    # the values that scripts read
    assert eye.location == [4, 5, 6]


def test_a_flat_root_is_no_obstacle() -> None:
    plate, eye = tree(empty("robot"), solid("head")), solid("eye")
    plate.scale = [1, 1, 0]
    gather_under_root(library(plate, eye))
    assert eye.parent is plate


def test_private_objects_and_lights_are_dropped() -> None:
    lamp = Node("lamp", NodeKind.LIGHT, location=[0, 0, 5])
    bulb, hidden, helper = solid("bulb"), solid("_hidden"), solid("_helper")
    bulb.location = [0, 0, 1]
    robot = tree(empty("robot"), tree(lamp, bulb), tree(hidden, solid("under hidden")))
    root = gather_under_root(library(robot, helper))
    assert [node.name for node in root.walk()] == ["robot", "bulb"]
    assert bulb.world_matrix().translation == pytest.approx((0, 0, 6))


def test_what_hangs_on_a_lamp_without_parent_is_kept() -> None:
    lamp, bulb = Node("lamp", NodeKind.LIGHT, location=[0, 0, 5]), solid("bulb")
    bulb.location = [0, 0, 1]
    robot = empty("robot")
    gather_under_root(library(tree(lamp, bulb), robot))
    assert bulb.parent is robot
    assert bulb.world_matrix().translation == pytest.approx((0, 0, 6))


def test_templates_outside_the_scene_are_no_parts() -> None:
    robot, template = solid("robot"), solid("template")
    root = gather_under_root(library(robot, template, outside=["template"]))
    assert [node.name for node in root.walk()] == ["robot"]
    # unless there is nothing else
    assert gather_under_root(library(solid("only"), outside=["only"])).name == "only"


@pytest.mark.parametrize("roots", [[], [Node("lamp", NodeKind.LIGHT)], [solid("_private")]])
def test_a_file_without_a_component_is_refused(roots: list[Node]) -> None:
    with pytest.raises(AssetError, match=r"models/robot\.blend: it contains no object that could be a component"):
        gather_under_root(library(*roots))


def test_every_object_ends_up_once_below_the_root() -> None:
    for order in itertools.permutations(range(4)):
        parts = [solid("a"), tree(empty("b"), solid("b1")), Node("arm", NodeKind.ARMATURE), solid("robot")]
        root = gather_under_root(library(*(parts[k] for k in order)))
        assert root.name == "robot"
        assert sorted(node.name for node in root.walk()) == ["a", "arm", "b", "b1", "robot"]
