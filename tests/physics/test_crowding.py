"""Many bodies at one place: the run goes on, with short ticks, and everything else behaves as before."""

import math
from typing import Any

import mujoco
import pytest

from morse.physics import forward as forward_module
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
