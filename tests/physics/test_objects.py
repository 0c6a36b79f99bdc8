"""The handle of an object: tree, poses, properties, holding, rays."""

import math
from itertools import chain

import pytest
from worlds import box, ground, node, rigid, robot, run, sphere, world

from morse.core.mathutils import Euler, Quaternion, Vector
from morse.scene import Node


def robot_with_eyes(name="robot", **pose):
    body = robot(name, **pose)
    for side, y in (("left_eye", 0.1), ("right_eye", -0.1)):
        eye = Node(side if name == "robot" else f"{side}.001", location=[0.25, y, 0.1], source_name=side)
        eye.attach(Node(f"{name}_{side}_pupil", location=[0.02, 0, 0]))
        body.attach(eye)
    return body


def test_children_are_found_by_the_name_in_the_model():
    first, second = robot_with_eyes(), robot_with_eyes("other", at=(3, 0, 0.25))
    w = world(first, second, robots=[first, second])
    assert w.game_object("robot").children["left_eye"].name == "left_eye"
    assert w.game_object("other").children["left_eye"].name == "left_eye.001"
    assert "left_eye" in w.game_object("other").children
    assert [c.name for c in w.game_object("robot").children] == ["left_eye", "right_eye"]
    assert len(w.game_object("robot").childrenRecursive) == 4


def test_a_misspelt_child_gets_the_nearest_name():
    body = robot_with_eyes()
    w = world(body, robots=[body])
    with pytest.raises(KeyError, match="did you mean 'left_eye'"):
        w.game_object("robot").children["left_eyes"]


def test_a_child_turns_in_place_and_takes_its_children_along():
    body = robot_with_eyes()
    body.rotation_euler = [0, 0, math.pi / 2]
    w = world(body, robots=[body])
    eye = w.game_object("robot").children["left_eye"]
    before = eye.worldPosition
    eye.orientation = Euler([0, 0, math.pi / 2]).to_matrix()
    assert tuple(eye.worldPosition) == pytest.approx(tuple(before))
    # a quarter turn of the robot and one of the eye: its X axis points along -X of the world
    assert tuple(eye.worldOrientation @ Vector([1, 0, 0])) == pytest.approx((-1, 0, 0), abs=1e-9)
    pupil = eye.children[0]
    assert tuple(pupil.worldPosition - eye.worldPosition) == pytest.approx((-0.02, 0, 0), abs=1e-9)
    assert tuple(pupil.localPosition) == pytest.approx((0.02, 0, 0))


def test_a_turned_child_rides_with_its_robot():
    body = robot_with_eyes()
    w = world(ground(), body, robots=[body])
    eye = w.game_object("robot").children["left_eye"]
    eye.localOrientation = [0.3, 0, 0]
    run(w, 1.0, lambda: w.game_object("robot").drive((1, 0, 0), (0, 0, 0), ground=True))
    assert tuple(eye.worldPosition) == pytest.approx((1.25, 0.1, 0.35), abs=5e-3)
    assert tuple(eye.localOrientation.to_euler()) == pytest.approx((0.3, 0, 0), abs=1e-9)


def test_turning_a_child_every_tick_adds_no_errors():
    body = robot_with_eyes()
    w = world(ground(), body, robots=[body])
    eye = w.game_object("left_eye")

    def drive():
        w.game_object("robot").drive((0.3, 0, 0), (0, 0, 0.5), ground=True)
        eye.localOrientation = [0.7, 0, 0]
        eye.localPosition = [0.25, 0.1, 0.1]

    run(w, 20.0, drive)
    m = eye.worldOrientation
    assert [tuple(row) for row in m @ m.transposed()] == [
        pytest.approx(row, abs=1e-12) for row in ((1, 0, 0), (0, 1, 0), (0, 0, 1))
    ]
    assert tuple(eye.children[0].localPosition) == pytest.approx((0.02, 0, 0), abs=1e-12)


def test_the_view_learns_of_a_displaced_child():
    body = robot_with_eyes()
    w = world(body, robots=[body])
    assert [n.name for n, _ in w.moving_nodes()] == ["robot"]
    layout = w.layout
    w.game_object("left_eye").localOrientation = [0.3, 0, 0]
    assert [(n.name, f) for n, f in w.moving_nodes()] == [("robot", "world"), ("left_eye", "parent")]
    assert w.layout != layout
    assert w.poses()[1] == pytest.approx([0.25, 0.1, 0.1, math.cos(0.15), math.sin(0.15), 0, 0], abs=1e-6)


def test_the_view_gets_the_pose_of_everything_that_moves():
    ghost, seen = Node("ghost", location=[1, 2, 3], rotation_euler=[0, math.pi, 0]), robot(at=(5, 0, 0.25))
    w = world(ground(), ghost, seen, rigid("Ball", sphere(0.5), at=(0, 0, 4)), robots=[ghost, seen])
    start = w.poses()
    w.game_object("ghost").worldPosition = [-1, 0, 2]
    w.game_object("ghost").worldOrientation = Euler([0, 0, math.radians(150)])
    run(w, 0.5, lambda: w.game_object("ghost").drive((1.0, 0, 0), (0, 0, 0.4)))
    shown = {n.name: row for (n, _), row in zip(w.moving_nodes(), w.poses(), strict=True)}
    assert set(shown) == {"ghost", "robot", "Ball"}
    for name, row in shown.items():
        obj = w.game_object(name)
        assert row[:3] == pytest.approx(tuple(obj.worldPosition), abs=1e-6)
        turned = Quaternion(row[3:].tolist()).to_matrix()
        assert [*chain(*turned)] == pytest.approx([*chain(*obj.worldOrientation)], abs=1e-6)
    half = math.radians(75) + 0.1
    assert shown["ghost"][3:] == pytest.approx([math.cos(half), 0, 0, math.sin(half)], abs=1e-6)
    w.reset()
    assert w.poses() == pytest.approx(start)


def test_moving_a_shape_of_a_body_moves_its_collisions():
    body = robot()
    body.attach(node("arm", box(0.2, 0.2, 0.2), at=(0.6, 0, 0)))
    w = world(body, Node("probe", location=[0.6, 2, 5]), robots=[body], gravity=0)
    probe = w.game_object("probe")
    assert probe.rayCastTo([0.6, 2, 0]) is None
    w.game_object("arm").localPosition = [0.6, 2, 0]
    w.sync()
    hit, point, _ = probe.rayCast([0.6, 2, 0])
    assert hit.name == "arm"
    assert tuple(point) == pytest.approx((0.6, 2, 0.35), abs=1e-6)


def test_teleporting_a_body_keeps_its_shape_upright():
    w = world(ground(), rigid("Box", box(1, 1, 1), at=(0, 0, 0.5)))
    obj = w.game_object("Box")
    obj.worldPosition = [3, 4, 0.5]
    obj.worldOrientation = Euler([0, 0, 1.0])
    run(w, 1.0)
    assert tuple(obj.worldPosition) == pytest.approx((3, 4, 0.5), abs=2e-3)
    assert obj.worldOrientation.to_euler().z == pytest.approx(1.0, abs=1e-3)


def test_velocities_in_both_frames():
    body = robot(at=(0, 0, 5))
    body.rotation_euler = [0, 0, math.pi / 2]
    w = world(body, gravity=0)
    obj = w.game_object("robot")
    obj.setLinearVelocity([1, 0, 0], True)
    assert tuple(obj.worldLinearVelocity) == pytest.approx((0, 1, 0), abs=1e-12)
    obj.worldAngularVelocity = [0, 0, 2]
    assert tuple(obj.getAngularVelocity(True)) == pytest.approx((0, 0, 2), abs=1e-12)


def test_a_point_away_from_the_axis_moves_with_the_turn():
    body = robot_with_eyes(at=(0, 0, 5))
    w = world(body, gravity=0)
    w.game_object("robot").worldAngularVelocity = [0, 0, 2]
    # w x r with r = (0.25, 0.1, 0.1)
    assert tuple(w.game_object("left_eye").worldLinearVelocity) == pytest.approx((-0.2, 0.5, 0), abs=1e-9)


def test_a_suspended_body_stays_until_it_is_released():
    w = world(rigid("Ball", sphere(0.1), at=(0, 0, 5)))
    ball = w.game_object("Ball")
    ball.suspendDynamics()
    run(w, 1.0)
    assert ball.worldPosition.z == pytest.approx(5)
    ball.restoreDynamics()
    run(w, 0.5)
    assert ball.worldPosition.z < 4


def test_a_held_object_goes_along_and_falls_when_released():
    carrier = Node("carrier", location=[0, 0, 2])
    w = world(ground(), carrier, rigid("Ball", sphere(0.1), at=(0.5, 0, 2)), robots=[carrier])
    ball, obj = w.game_object("Ball"), w.game_object("carrier")
    ball.setParent(obj)
    assert ball.parent is obj
    run(w, 2.0, lambda: obj.drive((0.5, 0, 0), (0, 0, 0)))
    assert tuple(ball.worldPosition) == pytest.approx((1.5, 0, 2), abs=1e-6)
    ball.removeParent()
    assert ball.parent is None
    run(w, 2.0)
    assert ball.worldPosition.z == pytest.approx(0.1, abs=0.01)


def test_rays_hit_what_is_first_and_look_through_the_own_body():
    body = robot()
    w = world(
        body,
        node("Near", box(0.2, 1, 1), at=(2, 0, 0)),
        node("Far", box(0.2, 1, 1), at=(4, 0, 0)),
        robots=[body],
        gravity=0,
    )
    obj = w.game_object("robot")
    hit, point, normal = obj.rayCast([10, 0, 0.25], None, 20)
    assert hit.name == "Near"
    assert tuple(point) == pytest.approx((1.9, 0, 0.25))
    assert tuple(normal) == pytest.approx((-1, 0, 0))
    assert obj.rayCast([1, 0, 0.25])[0] is None
    assert obj.rayCastTo([0, 5, 0.25], 20) is None


def test_rays_look_for_a_property():
    w = world(node("Near", box(0.2, 1, 1), at=(2, 0, 0)), node("Far", box(0.2, 1, 1), at=(4, 0, 0)), Node("eye"))
    w.game_object("Far")["Tag"] = True
    eye = w.game_object("eye")
    assert eye.rayCast([10, 0, 0], None, 20, "Tag") == (None, None, None)
    assert eye.rayCast([10, 0, 0], None, 20, "Tag", 0, 1)[0].name == "Far"


def test_properties_behave_like_a_dictionary():
    stone = rigid("Stone", sphere(0.1), at=(0, 0, 0))
    stone.properties["Graspable"] = True
    w = world(stone)
    obj = w.game_object("Stone")
    assert "Graspable" in obj
    assert obj["Graspable"] is True
    obj["Label"] = "stone"
    assert obj.get("Label") == "stone"
    assert obj.get("Missing", 3) == 3
    w.reset()
    assert "Label" not in obj


@pytest.mark.parametrize("bad", [[1, 2], [1, 2, "x"], [1, 2, math.nan], None, 5])
def test_positions_that_are_none_are_refused(bad):
    w = world(rigid("Ball", sphere(0.1), at=(0, 0, 0)))
    with pytest.raises(ValueError, match="position"):
        w.game_object("Ball").worldPosition = bad


def test_vector_and_distance_to_another():
    body = robot(at=(0, 0, 0))
    body.rotation_euler = [0, 0, math.pi / 2]
    w = world(body, node("Target", box(1, 1, 1), at=(0, 3, 4)))
    distance, seen, own = w.game_object("robot").getVectTo(w.game_object("Target"))
    assert distance == pytest.approx(5)
    assert tuple(seen) == pytest.approx((0, 0.6, 0.8))
    assert tuple(own) == pytest.approx((0.6, 0, 0.8))


def test_mass_is_the_body_s():
    w = world(ground(), rigid("Ball", sphere(0.1), at=(0, 0, 1), mass=2.5))
    assert w.game_object("Ball").mass == pytest.approx(2.5)
    assert w.game_object("Ground").mass == 0
    # a solid sphere: 2/5 m r^2
    assert tuple(w.game_object("Ball").localInertia) == pytest.approx([0.4 * 2.5 * 0.01] * 3)


def test_the_view_gets_the_pose_of_a_static_object_that_was_moved():
    shelf = node("Shelf", box(0.5, 0.5, 0.5), at=(4, 0, 0.5))
    w = world(ground(), shelf, rigid("Ball", sphere(0.5), at=(0, 0, 4)))
    assert [n.name for n, _ in w.moving_nodes()] == ["Ball"]
    layout = w.layout
    w.game_object("Shelf").worldPosition = [1, 2, 0.5]
    assert [(n.name, f) for n, f in w.moving_nodes()] == [("Ball", "world"), ("Shelf", "world")]
    assert w.layout != layout
    assert w.poses()[1] == pytest.approx([1, 2, 0.5, 1, 0, 0, 0], abs=1e-6)
    moved = w.get_state()
    layout = w.layout
    w.game_object("Shelf").worldPosition = [2, 2, 0.5]
    assert w.layout == layout
    w.reset()
    assert [n.name for n, _ in w.moving_nodes()] == ["Ball"]
    w.set_state(moved)
    assert w.poses()[1] == pytest.approx([1, 2, 0.5, 1, 0, 0, 0], abs=1e-6)


def test_a_static_object_without_a_shape_stays_where_it_was_moved():
    sign = Node("Sign", location=[4, 0, 0.5])
    w = world(ground(), sign, rigid("Ball", sphere(0.5), at=(0, 0, 4)))
    w.game_object("Sign").worldPosition = [1, 2, 0.5]
    run(w, 0.1)
    moved = w.get_state()
    w.add([rigid("Other", sphere(0.5), at=(3, 3, 4))])
    assert tuple(w.game_object("Sign").worldPosition) == (1, 2, 0.5)
    w.remove([w.game_object("Other")])
    w.reset()
    w.set_state(moved)
    assert tuple(w.game_object("Sign").worldPosition) == (1, 2, 0.5)
