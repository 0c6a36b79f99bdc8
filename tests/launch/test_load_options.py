"""Invalid options of ``morse.load``: refused before anything is loaded."""

import gc
import math
import sys
import threading
import tracemalloc
import weakref
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import launch_scenes
import numpy as np
import pytest

import morse
from morse.builder import ATRV, Environment
from morse.builder.script import load_scene
from morse.launch.load import described
from morse.launch.rereading import Rereading, script_stamp, source_stamps
from morse.simulation.options import RunOptions
from tests.kit.programs import new_processes


def scene() -> None:
    ATRV("robot")
    Environment("empty", fastmode=True)


@pytest.mark.parametrize(
    ("option", "value", "error", "text"),
    [
        ("view", True, ValueError, "'web', 'studio' or None, not True"),
        ("view", "browser", ValueError, "not 'browser'"),
        ("seed", 1.5, TypeError, "seed is an integer"),
        ("seed", "3", TypeError, "seed is an integer"),
        ("seed", True, TypeError, "seed is an integer"),
        ("arguments", "--fast", TypeError, "list of strings"),
        ("arguments", [1], TypeError, "list of strings"),
        ("speed", 0.0, ValueError, "positive"),
        ("speed", -1.0, ValueError, "positive"),
        ("speed", math.nan, ValueError, "positive"),
        ("speed", "max", TypeError, "speed is a number"),
        ("view_port", 70000, ValueError, "0 to 65535"),
        ("view_port", "8765", TypeError, "integer"),
    ],
)
def test_options_that_cannot_be_are_refused(option: str, value: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        morse.load(scene, **{option: value})


def test_numbers_of_numpy_are_numbers() -> None:
    with morse.load(scene, seed=np.int64(3), speed=np.float64(2.0)) as sim:
        sim.step(1)
        assert sim.ticks == 1


# -- the modules of a project belong to its simulation ---------------------------------------------


def test_imports_within_a_tick_find_the_project(project: Path) -> None:
    with morse.load(project) as simulation:
        simulation.step()
        assert simulation.robot.counter.data["late"] == 42
        assert not [name for name in sys.modules if name.startswith("mine")]


def test_imports_within_a_tick_do_not_depend_on_the_thread(project: Path) -> None:
    failures: list[BaseException] = []
    simulations = [morse.load(project) for _ in range(4)]

    def run(simulation: Any) -> None:
        try:
            for _ in range(20):
                simulation.step()
                assert simulation.robot.counter.data["late"] == 42
        except BaseException as error:
            failures.append(error)

    threads = [threading.Thread(target=run, args=(simulation,)) for simulation in simulations]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    for simulation in simulations:
        assert simulation.robot.counter.data["n"] == 20
        simulation.close()
    assert not failures
    assert not [name for name in sys.modules if name.startswith("mine")]


def test_each_simulation_has_variables_of_its_own(project: Path) -> None:
    with morse.load(project) as first, morse.load(project) as second:
        first.step(3)
        second.step(5)
        assert (first.robot.counter.data["n"], second.robot.counter.data["n"]) == (3, 5)
        first.restart()  # creates the components again, not the modules
        first.step()
        assert first.robot.counter.data["n"] == 4


def test_a_module_of_the_process_with_the_same_name_is_left_alone(project: Path, monkeypatch: Any) -> None:
    from types import ModuleType

    mine = ModuleType("mine")
    monkeypatch.setitem(sys.modules, "mine", mine)
    with morse.load(project) as simulation:
        simulation.step()
        assert simulation.robot.counter.data["late"] == 42
        assert sys.modules["mine"] is mine


def test_two_projects_whose_modules_have_the_same_names(project: Path, tmp_path: Path) -> None:
    import shutil

    other = tmp_path / "other"
    shutil.copytree(project.parent / "src", other / "src")
    (other / "scene.py").write_text(project.read_text())
    (other / "src" / "mine" / "later.py").write_text("VALUE = 100\n")
    with morse.load(project) as first, morse.load(other / "scene.py") as second:
        for simulation in (first, second):
            simulation.step()
        assert (first.robot.counter.data["late"], second.robot.counter.data["late"]) == (42, 202)


# -- many simulations in one process ---------------------------------------------------------------

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
    with new_processes() as pool:
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


# -- a script that is saved while the simulation starts counts as edited ---------------------------

SCENE = """
from morse.builder import *
robot = ATRV("rover")
Environment("empty", fastmode=True)
"""


def test_a_script_that_is_saved_while_the_simulation_starts_is_edited(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    options = RunOptions(script=str(script))
    loaded = script_stamp(options)
    scene = load_scene(options)
    loaded |= source_stamps(scene)
    script.write_text(SCENE.replace("rover", "other"))
    simulation: Any = SimpleNamespace(observers=[], view=None, stop=lambda: None)
    rereading = Rereading(options, scene, loaded)
    assert rereading.edited(simulation) == [str(script)]
    assert rereading.start_anew(simulation)
    assert rereading.successor is not None
    again, options, loaded = rereading.successor
    assert [robot.name for robot in again.roots if robot.name in ("rover", "other")] == ["other"]
    assert Rereading(options, again, loaded).edited(simulation) == []
    again.project.leave()
