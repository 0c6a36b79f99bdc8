"""Many bodies at one place: the run goes on, with short ticks, and everything else behaves as before."""

import math
from typing import Any

import mujoco
import numpy as np
import pytest
from worlds import bits, box, ground, node, rigid, robot, run, world

from morse.physics import engine_functions as forward_module
from tests.kit.scenes import Load

SCENE = """
from morse.builder import *
for number in range({count}):
    box = Cube(f"Box{{number}}")
    box.scale = (0.2, 0.2, 0.2)
    box.location = ({gap} * number, 0.0, 0.2)
    box._bpy_object.game.physics_type = "RIGID_BODY"
alone = Cube("Alone")
alone.scale = (0.2, 0.2, 0.2)
alone.location = (0.0, 5.0, 2.0)
alone._bpy_object.game.physics_type = "RIGID_BODY"
robot = FakeRobot()
env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def made(load: Load) -> Load:
    return lambda count, gap: load(SCENE.format(count=count, gap=gap))


def floating(simulation: Any) -> int:
    """The number of bodies that float."""
    return int((simulation.world.model.body_gravcomp == 1.0).sum())


def move_all_to_one_place(simulation: Any, count: int) -> None:
    for number in range(count):
        simulation.call("simulation", "set_object_position", f"Box{number}", [3.0, 3.0, 0.5])


def test_what_is_moved_into_each_other_floats_and_the_rest_falls(made: Any) -> None:
    """The engine runs out of memory in the first step."""
    count = 100
    simulation = made(count, 0.5)
    simulation.step()
    assert floating(simulation) == 0
    move_all_to_one_place(simulation, count)
    simulation.step(120)
    world = simulation.world
    assert 0 < floating(simulation) <= count
    assert world.data.ncon < 2500 + 16 * count
    assert all(math.isfinite(c) for obj in world.objects() for c in obj.worldPosition)
    assert world.game_object("Alone").worldPosition[2] == pytest.approx(0.2, abs=0.01), "it has fallen to the floor"
    state, first = simulation.save(), simulation.state_hash()
    simulation.step(5)
    later = simulation.state_hash()
    simulation.restore(state)
    assert simulation.state_hash() == first
    simulation.step(5)
    assert simulation.state_hash() == later
    simulation.restart(1)
    simulation.step()
    assert floating(simulation) == 0


def test_boxes_beside_each_other_and_in_a_heap_collide(made: Any) -> None:
    simulation = made(60, 0.42)
    for number in range(60):
        place = [0.45 * (number % 2), 0.45 * (number // 2 % 2), 0.25 + 0.41 * (number // 4)]
        simulation.call("simulation", "set_object_position", f"Box{number}", place)
    simulation.step(60)
    assert floating(simulation) == 0


def test_the_contacts_of_robots_at_their_poses_in_the_scene_are_not_computed(
    made: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """All robots are spawned at one place, and leave it before the next robot comes."""
    simulation, forward, most = made(1, 0.0), mujoco.mj_forward, 0

    def counted(model: Any, data: Any) -> None:
        nonlocal most
        forward(model, data)
        most = max(most, data.ncon)

    monkeypatch.setattr(mujoco, "mj_forward", counted)
    for number in range(5):
        simulation.spawn(f"new{number}", "ATRV", (8.0, 8.0, 0.0))
        simulation.call("simulation", "set_object_position", f"new{number}", [12.0 + 3.0 * number, 0.0, 0.1])
        simulation.step()
    assert 0 < most < 30


def test_only_memory_that_is_exhausted_by_other_contacts_ends_the_run(
    made: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    simulation = made(1, 0.0)
    simulation.step()

    def full(*_: Any) -> None:
        raise mujoco.FatalError("mj_stackAlloc: out of memory")

    monkeypatch.setattr("morse.physics.steps.mujoco.mj_step", full)
    from morse.physics import UnstableError

    with pytest.raises(UnstableError, match="exhaust the memory of the engine"):
        simulation.step()


def test_without_memory_for_contacts_the_poses_are_computed(made: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = made(1, 0.0)
    world, forward = simulation.world, mujoco.mj_forward

    def full(model: Any, data: Any) -> None:
        if not model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_CONTACT:
            raise mujoco.FatalError("mj_stackAlloc: out of memory")
        forward(model, data)

    monkeypatch.setattr(forward_module.mujoco, "mj_forward", full)
    world.reset()
    assert world.data.ncon == 0
    assert world.game_object("Alone").worldPosition[2] == pytest.approx(2.0)


# -- robots that push something are driven in one pass, exactly like robots that are driven one by one

COUNT = 4


def pushers(obstacle):
    bodies = [robot(f"robot{i}", at=(0, 1.5 * i, 0.25)) for i in range(COUNT)]
    others = [obstacle(i) for i in range(COUNT)]
    return world(ground(), *bodies, *others, robots=bodies)


def crate(i):
    return rigid(f"crate{i}", box(0.4, 0.4, 0.4), at=(0.5, 1.5 * i + 0.05, 0.2), mass=3.0)


def post(i):
    return node(f"post{i}", box(0.4, 0.4, 0.8), at=(0.5, 1.5 * i, 0.4))


class Pair:
    """The same world twice: robots of one are driven as a fleet, those of the other one by one."""

    def __init__(self, obstacle):
        self.together, self.alone = pushers(obstacle), pushers(obstacle)
        self.fleet = self.together.fleet([self.together.game_object(f"robot{i}") for i in range(COUNT)])
        self.single = []
        self.lasting = None
        drive = self.together.drives._drive_body
        self.together.drives._drive_body = lambda *arguments: self.single.append(1) or drive(*arguments)

    def tick(self, v, w, position, grounded):
        if (v, w, position, grounded) != self.lasting:
            self.lasting = v, w, position, grounded
            for i in range(COUNT):
                self.together.game_object(f"robot{i}").drive((v, 0, 0), (0, 0, w), position=position, ground=grounded)
                assert self.fleet.adopt(i)
        self.fleet.drive()
        for i in range(COUNT):
            self.alone.game_object(f"robot{i}").drive((v, 0, 0), (0, 0, w), position=position, ground=grounded)
        for each in (self.together, self.alone):
            each.step()

    def are_equal(self):
        return bits(self.together.get_state()) == bits(self.alone.get_state())

    def travelled(self, name):
        return float(self.together.game_object(name).worldPosition.x)


@pytest.mark.parametrize("grounded", [True, False])
@pytest.mark.parametrize("position", [True, False])
def test_crates_are_pushed_alike(position, grounded):
    pair = Pair(crate)
    for k in range(60):
        # they start, go straight, turn, and stop
        v, w = (0.5, 0.0 if k < 30 else 0.4) if k < 50 else (0.0, 0.0)
        pair.tick(v, w, position, grounded)
        assert pair.are_equal(), k
    for i in range(COUNT):
        assert pair.travelled(f"crate{i}") > 0.6


def test_only_robots_that_start_or_stop_are_driven_one_by_one():
    pair = Pair(crate)
    for _ in range(3):
        pair.tick(0.5, 0.0, False, True)
    assert len(pair.single) == COUNT
    for k in range(60):
        pair.tick(0.5 + 0.001 * k, 0.1, False, True)
    assert not pair.together.gliding.glides
    assert len(pair.single) == COUNT
    for _ in range(2):
        pair.tick(0.0, 0.0, False, True)
    assert len(pair.single) == 2 * COUNT


def test_robots_that_stand_still_against_a_wall_do_not_glide_and_do_not_enter_it():
    pair = Pair(post)
    for _ in range(90):
        pair.tick(0.3, 0.0, True, True)
    assert pair.are_equal()
    assert not pair.together.gliding.glides
    for i in range(COUNT):
        # the front of a robot is 0.25 m ahead of its origin, the post begins at 0.3 m
        assert pair.travelled(f"robot{i}") == pytest.approx(0.05, abs=0.02)


def test_robots_that_are_free_again_glide():
    pair = Pair(post)
    for _ in range(60):
        pair.tick(0.3, 0.0, False, True)
    for _ in range(60):
        pair.tick(-0.3, 0.0, False, True)
    assert pair.are_equal()
    assert len(pair.together.gliding.glides) == COUNT


# -- contact points, for observers -----------------------------------------------------------------

MASS = 12.0


def driven_world():
    body = robot(mass=MASS)
    return world(ground(), body, rigid("Box", box(0.5, 0.5, 0.5), at=(1.5, 0, 0.25), mass=1.0), robots=[body])


def drive(w):
    w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0), ground=True)


def contacts(w):
    return np.frombuffer(w.contact_forces(), dtype=np.float32).reshape(-1, 6)


@pytest.mark.parametrize("seconds", [0.5, 5.0], ids=["awake", "asleep"])
def test_contact_forces_carry_the_weight(seconds):
    w = world(ground(), rigid("Box", box(0.5, 0.5, 0.5), at=(0, 0, 0.25), mass=7.0))
    run(w, seconds)
    rows = contacts(w)
    assert np.abs(rows[:, 2]).max() < 1e-2
    assert rows[:, 5].sum() == pytest.approx(7.0 * 9.81, rel=0.02)


def test_a_robot_that_glides_is_seen_to_stand_on_its_feet():
    w = driven_world()
    run(w, 1.0, lambda: drive(w))
    assert w.gliding.supports()
    rows = contacts(w)
    feet = rows[rows[:, 0] < 1.0]
    assert len(feet) == 4
    assert feet[:, 2] == pytest.approx(0.0, abs=0.01)
    assert feet[:, 5].sum() == pytest.approx(MASS * 9.81, rel=0.02)


def test_looking_at_contacts_changes_nothing():
    seen, unseen = driven_world(), driven_world()
    for _ in range(200):
        for w in (seen, unseen):
            drive(w)
            w.step()
        contacts(seen)
        assert seen.data.qpos.tobytes() == unseen.data.qpos.tobytes()
        assert seen.data.qvel.tobytes() == unseen.data.qvel.tobytes()
