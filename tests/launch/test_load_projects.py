"""The modules of a project belong to its simulation."""

import sys
import threading
from pathlib import Path
from typing import Any

import morse


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
