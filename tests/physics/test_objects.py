"""The handle of an object: tree, poses, properties, holding, rays."""

import math
import sys
from itertools import chain
from pathlib import Path
from typing import Any

import pytest
from worlds import box, ground, node, rigid, robot, run, sphere, world

import morse
from morse.core.mathutils import Euler, Quaternion, Vector
from morse.mathutils import Matrix
from morse.physics.poses.rigid import relative_pose
from morse.physics.studio import Studio, StudioMissingError
from morse.scene import Node
from morse.scene.frames import rigid_frame


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


# -- parts that move within a body: their poses are computed when they are read, their shapes move at once


def crane(name, y):
    """A robot with a mast that carries a boom that carries a hook, which has a shape."""
    body = robot(name, at=(0, y, 0.25))
    mast = Node(f"{name}_mast", location=[0.1, 0, 0.25])
    boom = Node(f"{name}_boom", location=[0.5, 0, 0.2])
    hook = node(f"{name}_hook", box(0.1, 0.1, 0.1), at=(0.3, 0, 0))
    body.attach(mast)
    mast.attach(boom)
    boom.attach(hook)
    return body


@pytest.fixture
def cranes():
    bodies = [crane("read", 0.0), crane("unread", 3.0)]
    return world(*bodies, robots=bodies, gravity=0.0)


def turn(world, name, angle):
    c, s = math.cos(angle), math.sin(angle)
    mast = world.game_object(f"{name}_mast")
    mast.set_local_pose(mast.local_pose()[0], (c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0))


def test_reading_in_between_changes_nothing(cranes):
    parts = ("mast", "boom", "hook")
    for k in range(50):
        for name in ("read", "unread"):
            turn(cranes, name, 0.1 * k)
        for part in parts:
            cranes.game_object(f"read_{part}").world_pose()
        cranes.step()
    for part in parts:
        read, unread = cranes.game_object(f"read_{part}"), cranes.game_object(f"unread_{part}")
        assert read.offset == unread.offset
        (x, y, z), turned = unread.world_pose()
        assert (x, y - 3.0, z) == pytest.approx(tuple(read.world_pose()[0]), abs=1e-12)
        assert turned == pytest.approx(read.world_pose()[1], abs=1e-12)


def test_the_shape_of_an_outer_part_moves_although_nobody_reads_it(cranes):
    turn(cranes, "unread", math.pi / 2)
    cranes.step()
    slot = cranes.slots[cranes.game_object("unread_hook").slot]
    (geom,) = slot.geoms[cranes.game_object("unread_hook").node]
    # mast at 0.1 m ahead, boom and hook 0.8 m to its left
    assert cranes.data.geom_xpos[geom] == pytest.approx([0.1, 3.8, 0.7], abs=1e-6)
    assert tuple(cranes.game_object("unread_hook").world_pose()[0]) == pytest.approx((0.1, 3.8, 0.7), abs=1e-6)


def test_a_moved_part_moves_within_a_part_that_moves(cranes):
    boom = cranes.game_object("unread_boom")
    turn(cranes, "unread", math.pi / 2)
    boom.set_local_pose((1.0, 0.0, 0.0), boom.local_pose()[1])
    turn(cranes, "unread", math.pi)
    assert tuple(boom.world_pose()[0]) == pytest.approx((-0.9, 3.0, 0.5), abs=1e-9)
    cranes.reset()
    assert tuple(boom.world_pose()[0]) == pytest.approx((0.6, 3.0, 0.7), abs=1e-9)


# -- what is known of nodes is not computed again when another object comes or goes, and follows every change

SCENE = """
from morse.builder import *
for number in range(6):
    robot = ATRV(f"robot{number}")
    robot.translate(3.0 * number, 5.0, 0.0)
    robot.append(Pose("pose"))
env = Environment("empty", fastmode=True)
"""


def known_frames_chain() -> tuple[Node, Node, Node]:
    """A node, its parent, and the parent of the parent."""
    top, middle, leaf = Node("top"), Node("middle"), Node("leaf")
    top.attach(middle)
    middle.attach(leaf)
    leaf.location = [1.0, 0.0, 0.0]
    return leaf, middle, top


def test_a_frame_is_computed_once() -> None:
    leaf, middle, _ = known_frames_chain()
    first = rigid_frame(leaf)
    assert rigid_frame(leaf) is first
    assert relative_pose(leaf, rigid_frame(middle))[0] is relative_pose(leaf, rigid_frame(middle))[0]


def test_a_frame_follows_the_node_and_all_nodes_above_it() -> None:
    leaf, middle, top = known_frames_chain()
    assert tuple(rigid_frame(leaf).position) == (1.0, 0.0, 0.0)
    leaf.location[2] = 0.5  # in place
    assert tuple(rigid_frame(leaf).position) == (1.0, 0.0, 0.5)
    top.location = [0.0, 2.0, 0.0]
    assert tuple(rigid_frame(leaf).position) == (1.0, 2.0, 0.5)
    middle.scale = [3.0, 1.0, 1.0]
    assert tuple(rigid_frame(leaf).position) == (3.0, 2.0, 0.5)
    assert relative_pose(leaf, rigid_frame(top))[0] == pytest.approx([3.0, 0.0, 0.5])
    middle.rotation_euler = [0.0, 0.0, 3.141592653589793]
    assert tuple(rigid_frame(leaf).position) == pytest.approx((-3.0, 2.0, 0.5))
    middle.parent_inverse = Matrix.Translation((0.0, 0.0, 7.0))
    assert tuple(rigid_frame(leaf).position) == pytest.approx((-3.0, 2.0, 7.5))
    leaf.detach()
    assert tuple(rigid_frame(leaf).position) == (1.0, 0.0, 0.5)
    assert relative_pose(leaf, rigid_frame(top))[0] == pytest.approx([1.0, -2.0, 0.5])


def test_only_the_frames_of_what_comes_are_computed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scene.py").write_text(SCENE, encoding="utf-8")
    with morse.load(tmp_path / "scene.py") as simulation:
        simulation.spawn("before", "FakeRobot", (20.0, 0.0, 0.0))
        simulation.delete("before")
        computed: list[Any] = []
        from morse.scene import frames

        compute = frames._frame_of
        monkeypatch.setattr(frames, "_frame_of", lambda world: computed.append(world) or compute(world))
        simulation.spawn("newcomer", "FakeRobot", (20.0, 0.0, 0.0))
        came = sum(1 for _ in simulation.scene.find("newcomer").walk())
        assert len(computed) == came
        simulation.delete("newcomer")
        assert len(computed) == came
        simulation.step()
        x, y, _ = simulation.world.game_object("robot3").worldPosition
        assert (x, y) == pytest.approx((9.0, 5.0), abs=1e-3)


def test_a_restart_reads_no_signature_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "scene.py").write_text(SCENE, encoding="utf-8")
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with morse.load(tmp_path / "scene.py", sockets=True, interfaces=["socket"]) as simulation:
        read: list[Any] = []
        from morse.core.validation import arguments

        signature = arguments.signature_of
        monkeypatch.setattr(arguments, "signature_of", lambda method: read.append(method) or signature(method))
        simulation.restart(seed=1)
        assert read == []
        assert (
            "get_local_data"
            in simulation.call("simulation", "details").result()["robots"][0]["components"]["robot0.pose"]["services"]
        )


# -- muJoCo's own viewer is an extra ---------------------------------------------------------------


def test_without_the_extra_the_line_to_install_it_is_given(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco.studio", None)
    with pytest.raises(StudioMissingError, match=r'pip install "mujoco-studio>=4.0,<4.1"'):
        Studio(world(ground()), "127.0.0.1")
