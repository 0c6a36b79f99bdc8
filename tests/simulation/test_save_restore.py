"""Everything that determines the future is saved, and restored bit by bit."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import state_parts_of_users as users
import state_scenes as scenes
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import morse
from morse.builder import Environment, Human
from morse.core.state import StateError
from tests.kit.effort import examples
from tests.kit.programs import new_processes

PLANS = st.fixed_dictionaries(
    {
        "robots": st.lists(st.booleans(), min_size=1, max_size=3),
        "things": st.integers(0, 2),
        "scan": st.booleans(),
        "seed": st.integers(0, 2**32),
    }
)
PLAN = {"robots": [True, False], "things": 1, "scan": True, "seed": 5}


@pytest.fixture(scope="module")
def elsewhere() -> Iterator[Any]:
    """Another process."""
    with new_processes() as pool:
        yield pool


@given(plan=PLANS, before=st.integers(0, 40), after=st.integers(1, 40))
@settings(max_examples=examples(12), suppress_health_check=list(HealthCheck))
def test_another_process_goes_on_to_the_bit(
    elsewhere: Any, tmp_path_factory: pytest.TempPathFactory, plan: dict[str, Any], before: int, after: int
) -> None:
    file = tmp_path_factory.mktemp("states") / "state"
    with scenes.load(plan) as simulation:
        scenes.go(simulation, plan, before)
        simulation.save(file)
        scenes.go(simulation, plan, after)
        wanted = simulation.state_hash()
    assert elsewhere.apply(scenes.go_on, (plan, str(file), after)) == wanted


@given(plan=PLANS, before=st.integers(0, 40), after=st.integers(1, 40))
@settings(max_examples=examples(12), suppress_health_check=list(HealthCheck))
def test_the_same_simulation_goes_back_to_the_bit(plan: dict[str, Any], before: int, after: int) -> None:
    with scenes.load(plan) as simulation:
        scenes.go(simulation, plan, before)
        state = simulation.save()
        scenes.go(simulation, plan, after)
        wanted = simulation.state_hash()
        simulation.restore(state)
        assert simulation.state_hash() == state.hash()
        assert simulation.ticks == state.tick == before
        scenes.go(simulation, plan, after)
        assert simulation.state_hash() == wanted


def test_a_state_can_be_restored_again_and_again() -> None:
    """The parts of a state refer to each other, also if its physics was validated before."""

    def scene() -> None:
        Human()
        Environment("empty")

    with morse.load(scene) as sim, morse.load(scene) as other:
        sim.step(3)
        state = sim.save()
        for simulation in (sim, other):
            for _ in range(4):
                simulation.restore(state)
                assert simulation.state_hash() == state.hash()
                simulation.step()


def test_to_save_changes_nothing() -> None:
    with scenes.load(PLAN) as watched, scenes.load(PLAN) as alone:
        for _ in range(20):
            scenes.go(watched, PLAN, 1)
            watched.save()
        scenes.go(alone, PLAN, 20)
        assert watched.state_hash() == alone.state_hash()


def test_attributes_share_what_they_shared() -> None:
    with scenes.load(PLAN) as first, scenes.load(PLAN) as second:
        scenes.go(first, PLAN, 7)
        second.restore(first.save())
        part = second.robot.everything.component
        assert part.estimate is part.same
        assert part.ring[1] is part.ring
        assert np.shares_memory(part.position, part.state)
        assert part.matrix.flags.f_contiguous
        assert part.mode in (users.SLOW, users.FAST)
        assert part.mode is users.FAST or part.mode is users.SLOW
        assert part.draw.__self__ is part.numpy_random
        assert part.friend in (second.robot.pose.component, second.robot.component)
        assert part.lists["new"] == []
        assert part.step.__self__ is part


def test_constants_of_a_module_stay_what_they_are() -> None:
    with scenes.load(PLAN) as simulation:
        states = []
        for _ in range(4):
            states.append(simulation.save())
            scenes.go(simulation, PLAN, 1)
        for state in reversed(states):
            simulation.restore(state)
    assert (users.Mode("slow", 0.5), users.Mode("fast", 2.0)) == (users.SLOW, users.FAST)
    assert users.HOME.tolist() == [1.0, 2.0, 3.0]


def test_a_command_that_waits_is_saved() -> None:
    with scenes.load(PLAN) as simulation, scenes.load(PLAN) as other:
        before = simulation.save()
        simulation.robot.motion.publish({"v": 1.0})
        other.restore(simulation.save())
        for each in (simulation, other):
            each.step(10)
        assert other.state_hash() == simulation.state_hash()
        assert other.robot.motion.data["v"] == 1.0
        simulation.robot.motion.publish({"v": 2.0})
        simulation.restore(before)
        simulation.step()
        assert simulation.robot.motion.data["v"] == 0.0


def test_what_cannot_be_saved_is_named_once(caplog: pytest.LogCaptureFixture) -> None:
    def scene() -> None:
        from morse.builder import Environment, FakeRobot
        from morse.builder.creator import SensorCreator

        class Unsaveable(SensorCreator):
            _classpath = "state_parts_of_users.Unsaveable"

        robot = FakeRobot("robot")
        robot.append(Unsaveable("part"))
        Environment("empty", fastmode=True)

    with morse.load(scene) as simulation:
        part = simulation.robot.part.component
        state = simulation.save()
        assert {text.partition(" ")[0] for text in state.unsaved} == {
            f"robot.part.{name}" for name in ("thread", "lock", "file")
        }
        kept = part.thread, part.lock, part.file
        simulation.step(3)
        simulation.restore(state)
        assert (part.thread, part.lock, part.file) == kept
        assert simulation.robot.part.data["count"] == 0
        simulation.save()
    assert len([record for record in caplog.records if "robot.part.thread" in record.getMessage()]) == 1


def test_a_state_of_another_scene_is_refused_with_the_differences() -> None:
    with scenes.load(PLAN) as simulation, scenes.load({**PLAN, "robots": [True], "scan": False}) as other:
        other.step(3)
        before = other.state_hash()
        with pytest.raises(StateError, match=r"another scene.*it has: .*robot\.scan"):
            other.restore(simulation.save())
        assert other.state_hash() == before
        with pytest.raises(StateError, match=r"another scene.*it lacks: .*robot1"):
            simulation.restore(other.save())


def test_services_under_way_end_as_preempted_and_not_for_a_state_that_is_refused() -> None:
    from pymorse import MorseServicePreempted

    with scenes.load(PLAN) as simulation, scenes.load({**PLAN, "robots": [True]}) as other:
        state = simulation.save()
        sleeping = simulation.call("time", "sleep", 1.0)
        simulation.step()
        with pytest.raises(StateError):
            simulation.restore(other.save())
        assert sleeping.running()
        simulation.restore(state)
        with pytest.raises(MorseServicePreempted):
            sleeping.result()


def test_a_service_that_goes_on_is_named_in_the_hash() -> None:
    """Two worlds with equal hashes have equal futures: one that holds a box by ``setParent`` has another hash."""
    with scenes.load(PLAN) as first, scenes.load(PLAN) as second:
        objects = first.world.objects_by_name
        assert first.state_hash() == second.state_hash()
        objects["crate0"].setParent(objects["robot"])
        assert first.state_hash() != second.state_hash()
        second.restore(first.save())
        for each in (first, second):
            scenes.go(each, PLAN, 40)
        assert first.state_hash() == second.state_hash()


def test_a_file_is_there_as_a_whole_or_not_at_all(tmp_path: Path) -> None:
    with scenes.load(PLAN) as simulation:
        with pytest.raises(FileNotFoundError):
            simulation.save(tmp_path / "nowhere" / "state")
        simulation.save(tmp_path / "state")
        simulation.save(str(tmp_path / "state"))
        assert [path.name for path in tmp_path.iterdir()] == ["state"]
