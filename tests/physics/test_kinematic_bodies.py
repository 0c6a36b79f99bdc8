"""Bodies of the type KINEMATIC: moved by one call, seen by rays, pushing what they meet, or touching nothing."""

import numpy as np
import pytest

import morse

SCENE = """
from morse.builder import *

for number, ghost in ((0, False), (1, True)):
    door = Cube(f"door{number}")
    door.scale = (0.05, 0.5, 1.0)
    door.translate(2 + number, 0, 1)
    door.set_physics_type("KINEMATIC")
    door.scene_node.body.ghost = ghost
box = Cube("box")
box.scale = (0.2, 0.2, 0.2)
box.translate(2.5, 2.0, 0.2)
box.set_rigid_body()
robot = FakeRobot("robot")
robot.translate(0, 0, 1)
scan = Hokuyo("scan")
robot.append(scan)
pose = Pose("pose")
robot.append(pose)
Environment("empty")
"""
UPRIGHT = np.array([[1.0, 0.0, 0.0, 0.0]] * 2)


@pytest.fixture
def sim(tmp_path):
    (tmp_path / "scene.py").write_text(SCENE, "utf-8")
    with morse.load(tmp_path / "scene.py") as simulation:
        yield simulation


def _doors(sim):
    world = sim.context.world
    return world, world.kinematic_bodies([world.objects_by_name[f"door{number}"] for number in (0, 1)])


def _ahead(sim):
    ranges = np.array(sim.robot.scan.get()["range_list"])
    return ranges[len(ranges) // 2]


def test_rays_hit_them_where_they_are(sim):
    _, doors = _doors(sim)
    assert _ahead(sim) == pytest.approx(1.95, abs=1e-6)
    doors.place(np.array([[3.0, 0.0, 1.0], [4.0, 5.0, 1.0]]), UPRIGHT)
    assert _ahead(sim) == pytest.approx(2.95, abs=1e-6)
    # turned by 90 degrees about Z, given with another length
    doors.place(np.array([[3.0, 0.0, 1.0], [2.0, 0.0, 1.0]]), np.array([[1.0, 0, 0, 0], [3.0, 0, 0, 3.0]]))
    assert _ahead(sim) == pytest.approx(1.5, abs=1e-6)


def test_one_that_collides_pushes_and_a_ghost_does_not(sim):
    world, doors = _doors(sim)
    box = world.objects_by_name["box"]
    sim.step(30)
    for tick in range(60):
        y = 0.5 + tick / 60.0
        doors.place(np.array([[7.0, 0.0, 1.0], [2.5, y, 1.0]]), UPRIGHT)
        sim.step()
    assert box.world_pose()[0][1] == pytest.approx(2.0, abs=0.01)
    for tick in range(60):
        y = 0.5 + 1.5 * tick / 60.0
        doors.place(np.array([[2.5, y, 1.0], [7.0, 0.0, 1.0]]), UPRIGHT)
        sim.step()
    # the half of the door, 0.5 m, and that of the box, which may have been kicked ahead
    assert y + 0.5 + 0.2 - 0.01 < box.world_pose()[0][1] < y + 0.5 + 0.2 + 0.5


def test_a_saved_state_has_their_poses(sim):
    _, doors = _doors(sim)
    doors.place(np.array([[3.0, 0.0, 1.0], [4.0, 5.0, 1.0]]), UPRIGHT)
    sim.step(3)
    state, digest, ahead = sim.save(), sim.state_hash(), _ahead(sim)
    doors.place(np.array([[2.0, 0.0, 1.0], [2.5, 0.0, 1.0]]), UPRIGHT)
    sim.step(3)
    assert sim.state_hash() != digest
    sim.restore(state)
    assert sim.state_hash() == digest
    assert _ahead(sim) == ahead


def test_a_ghost_that_moves_lets_a_robot_glide(tmp_path):
    """What has no body in the engine stirs nothing: a robot that is driven needs no step of the engine."""
    (tmp_path / "scene.py").write_text(
        SCENE + "\nrobot2 = ATRV('driven')\nrobot2.translate(-5, 0, 0.1)\n"
        "motion = MotionVW('motion')\nrobot2.append(motion)\n"
        "box.translate(50, 50, 0)\n",
        "utf-8",
    )
    with morse.load(tmp_path / "scene.py") as sim:
        world = sim.context.world
        ghost = world.kinematic_bodies([world.objects_by_name["door1"]])
        sim.driven.motion.publish({"v": 0.5, "w": 0.0})
        sim.step(120)
        driven = world.objects_by_name["driven"].slot
        for tick in range(30):
            ghost.place(np.array([[1.0 + 0.01 * tick, 3.0, 1.0]]), UPRIGHT[:1])
            sim.step()
            assert driven in world.gliding
            assert not world.is_stirred


@pytest.mark.parametrize(
    ("positions", "quaternions"),
    [
        (np.zeros((1, 3)), UPRIGHT),
        (np.zeros((2, 3)), UPRIGHT[:, :3]),
        (np.full((2, 3), np.nan), UPRIGHT),
        (np.full((2, 3), 1e30), UPRIGHT),
        (np.zeros((2, 3)), np.zeros((2, 4))),
        (np.zeros((2, 3)), np.full((2, 4), np.inf)),
    ],
)
def test_poses_that_are_none_are_refused_and_change_nothing(sim, positions, quaternions):
    _, doors = _doors(sim)
    before = sim.state_hash()
    with pytest.raises(ValueError, match=r"expected positions|at most"):
        doors.place(positions, quaternions)
    assert sim.state_hash() == before


def test_another_body_is_refused(sim):
    world = sim.context.world
    with pytest.raises(ValueError, match="'box' is not a kinematic body: its physics type is RIGID_BODY"):
        world.kinematic_bodies([world.objects_by_name["box"]])


def test_they_are_found_again_after_a_change_of_the_scene(sim):
    world, doors = _doors(sim)
    world.remove([world.objects_by_name["box"]])
    doors.place(np.array([[3.0, 0.0, 1.0], [4.0, 5.0, 1.0]]), UPRIGHT)
    assert _ahead(sim) == pytest.approx(2.95, abs=1e-6)
    world.remove([world.objects_by_name["door0"]])
    with pytest.raises(LookupError, match="'door0' has been removed"):
        doors.place(np.zeros((2, 3)), UPRIGHT)
