"""Many simulations in one process."""

import gc
import multiprocessing
import threading
import tracemalloc
import weakref
from pathlib import Path
from typing import Any

import launch_scenes
import pytest

import morse
from morse.launch.load import described
from morse.simulation.options import RunOptions

TICKS = 60


@pytest.fixture(scope="module")
def alone() -> str:
    """The state of a simulation that ran alone."""
    return launch_scenes.hash_after(TICKS)


def test_interleaved_simulations_are_independent_to_the_bit(alone: str) -> None:
    simulations = [morse.load(launch_scenes.driving, seed=3) for _ in range(3)]
    other = morse.load(launch_scenes.driving, seed=4)
    for tick in range(TICKS):
        for simulation in simulations:
            launch_scenes.drive(simulation, 1)
        other.step(tick % 3)
    assert [simulation.state_hash() for simulation in simulations] == [alone] * 3
    for simulation in [*simulations, other]:
        simulation.close()


def test_simulations_in_threads_are_independent_to_the_bit(alone: str) -> None:
    hashes: list[str] = []
    threads = [threading.Thread(target=lambda: hashes.append(launch_scenes.hash_after(TICKS))) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(100)
    assert hashes == [alone] * 4


def test_a_process_that_was_spawned(alone: str) -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(launch_scenes.hash_after, (TICKS,)) == alone


def test_copies_of_a_scene_are_independent(alone: str) -> None:
    scene = described(launch_scenes.driving, RunOptions())
    with morse.load(scene, seed=3) as first, morse.load(scene, seed=3) as second:
        launch_scenes.drive(first, TICKS)
        launch_scenes.drive(second, TICKS)
        assert first.state_hash() == second.state_hash() == alone


def test_a_restart_keeps_components_on_the_clock_of_their_simulation() -> None:
    with morse.load(launch_scenes.driving) as first, morse.load(launch_scenes.driving) as second:
        second.step(7)
        first.restart()
        for component in (*first.context.components.values(), *first.context.robots.values()):
            assert component.clock is first.clock
            assert component.context is first.context
        first.step(2)
        second.step()
        assert first.robot.pose.data["timestamp"] == pytest.approx(2 / 60)
        assert second.robot.pose.data["timestamp"] == pytest.approx(8 / 60)


def test_closed_simulations_are_freed(project: Path) -> None:
    def one(scene: Any) -> list[weakref.ref[Any]]:
        with morse.load(scene) as simulation:
            simulation.robot.motion.publish({"v": 1.0})
            simulation.robot.pose.get()
            simulation.restore(simulation.save())
            kept = (simulation, simulation.context, simulation.world, simulation.robot.pose.component)
            return [weakref.ref(each) for each in kept]

    for scene in (project, launch_scenes.driving):
        references = one(scene)
        gc.collect()
        assert [reference() for reference in references] == [None] * len(references)


@pytest.mark.parametrize("cycles", [8, pytest.param(30, marks=pytest.mark.slow)])
def test_memory_stays_where_it_was_after_many_simulations(project: Path, cycles: int) -> None:
    def cycle() -> None:
        with morse.load(project) as simulation:
            simulation.step()

    for _ in range(5):
        cycle()
    tracemalloc.start()
    try:
        cycle()  # objects that each cycle creates again, such as modules, are traced before, too
        gc.collect()
        before, _ = tracemalloc.get_traced_memory()
        for _ in range(cycles):
            cycle()
        gc.collect()
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    # one simulation takes some hundred kilobytes
    assert after - before < 300_000
