"""A model is saved while the simulation runs."""

import os
import shutil
import subprocess
import textwrap
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from watched import DATA, Project

from morse.core.journal import EDIT
from morse.physics.objects.object_world import RemovedError
from morse.scene import PhysicsType
from morse.simulation.simulation import Simulation
from morse.simulation.watching.watch import Watch
from tests.kit.waiting import step_until

SCENE = """
    robot = GroundRobot("mine.blend")
    robot.translate(1.0, 2.0, 0.2)
    pose = Pose()
    robot.append(pose)
    pose.translate(0.0, 0.0, 0.5)
    crate = PassiveObject("props/crates", "small_crate")
    crate.translate(-5.0, 0.0, 2.0)
    env = Environment("empty", fastmode=True)
"""


@pytest.fixture
def project(tmp_path: Path) -> Project:
    made = Project(tmp_path)
    made.model("robots/mine.blend", DATA / "robots" / "morsy.blend")
    return made


@pytest.fixture
def run(project: Project) -> Iterator[Simulation]:
    with project.load(SCENE) as simulation:
        yield simulation


def shown(simulation: Simulation, name: str = "robot") -> set[str]:
    """The parts of an object by their names in its file."""
    node = simulation.scene.find(name)
    assert node is not None
    return {part.plain_name for part in node.walk()}


def saved(run: Simulation, project: Project, model: str) -> None:
    before = run.world.arrangement
    project.model("robots/mine.blend", DATA / model)
    step_until(run, lambda: run.world.arrangement != before)


def test_the_robot_gets_the_new_model_and_its_physics(run: Simulation, project: Project) -> None:
    run.step(60)
    mass = run.world.object_of(run.scene.robots()[0].node).mass
    body = run.context.robots["robot"].bge_object
    sensor = run.context.components["robot.pose"]
    saved(run, project, "robots/atrv.blend")
    assert any("wheel" in name.lower() for name in shown(run))
    assert not any("morsy" in name.lower() and name != "robot" for name in shown(run))
    assert run.context.robots["robot"].bge_object is body
    assert run.context.components["robot.pose"] is sensor
    assert body.mass != mass
    assert len(body.node.shapes or []) + sum(len(n.shapes or []) for n in body.node.walk()) > 0


def test_what_hangs_on_the_robot_stays_where_it_was(run: Simulation, project: Project) -> None:
    run.step(60)
    saved(run, project, "robots/atrv.blend")
    robot, sensor = run.context.robots["robot"], run.context.components["robot.pose"]
    run.step()
    offset = sensor.bge_object.worldPosition - robot.bge_object.worldPosition
    assert offset.length == pytest.approx(0.5, abs=1e-3)
    assert robot.bge_object.worldPosition[:2] == pytest.approx([1.0, 2.0], abs=0.05)


def test_other_things_go_on_as_if_nothing_had_happened(project: Project) -> None:
    def fall(edit: bool) -> list[float]:
        project.model("robots/mine.blend", DATA / "robots" / "morsy.blend")
        with project.load(SCENE) as run:
            run.step(20)
            if edit:
                saved(run, project, "robots/atrv.blend")
            height = []
            while run.ticks < 600 or not height:  # the saved file may be found late, when the crate lies still
                run.step()
                height.append(run.world.game_object("crate").worldPosition[2])
        return height[-1:]

    assert fall(edit=True) == pytest.approx(fall(edit=False), abs=1e-4)


def test_start_anew_shows_the_new_model(run: Simulation, project: Project) -> None:
    saved(run, project, "robots/atrv.blend")
    run.restart()
    run.step()
    assert any("wheel" in name.lower() for name in shown(run))
    assert run.robot.pose.data["x"] == pytest.approx(1.0, abs=0.01)
    run.spawn("another", "ATRV", (5.0, 5.0, 0.3))
    run.restart()
    assert run.scene.find("another") is None
    assert any("wheel" in name.lower() for name in shown(run))


def test_what_was_not_touched_stays_the_same_node(run: Simulation, project: Project) -> None:
    """The file is saved without a change: nothing is replaced."""
    nodes = set(run.scene.nodes())
    messages: list[str] = []
    run.journal.sinks.append(lambda entry: messages.append(entry.kind))
    path = project.model("robots/mine.blend", DATA / "robots" / "morsy.blend")
    step_until(run, lambda: EDIT in messages)
    assert set(run.scene.nodes()) == nodes
    assert run.world.arrangement == 0
    assert path.exists()


def test_a_larger_model_is_not_shot_out_of_the_ground(run: Simulation, project: Project) -> None:
    run.step(120)
    saved(run, project, "robots/atrv.blend")
    heights = []
    for _ in range(60):
        run.step()
        heights.append(run.robot.pose.data["z"])
    # its origin is 0.1 m above its lowest point, and the sensor 0.5 m above that
    assert max(heights) == pytest.approx(0.6, abs=0.03)
    assert heights[-1] == pytest.approx(0.6, abs=0.03)


def test_watching_changes_not_one_bit(project: Project) -> None:
    hashes = []
    for watch in (True, False):
        with project.load(SCENE, watch=watch, seed=1) as run:
            run.step(200)
            hashes.append(run.state_hash())
    assert hashes[0] == hashes[1]


def test_paint_and_physics_of_the_script_stay(project: Project) -> None:
    with project.load(
        SCENE.replace("pose = Pose()", "robot.set_mass(77.0)\n    robot.set_no_collision()\n    pose = Pose()")
    ) as run:
        saved(run, project, "robots/atrv.blend")
        node = run.scene.find("robot")
        assert node is not None
        assert node.body.mass == 77.0
        assert node.body.type is PhysicsType.NO_COLLISION


@pytest.mark.parametrize("content", [b"", b"BLENDER-v304", b"no model at all", None])
def test_a_broken_or_missing_file_changes_nothing(
    run: Simulation, project: Project, caplog: pytest.LogCaptureFixture, content: bytes | None
) -> None:
    run.step(5)
    path = project.folder / "data" / "robots" / "mine.blend"
    if content is None:
        path.unlink()
        end = time.monotonic() + 1.0
        step_until(run, lambda: time.monotonic() > end)
    else:
        path.write_bytes(content)
        step_until(run, lambda: [record for record in caplog.records if record.levelname == "ERROR"])
        assert str(path) in caplog.text
    assert "morsy" in " ".join(shown(run)).lower()
    saved(run, project, "robots/atrv.blend")
    assert any("wheel" in name.lower() for name in shown(run))


def test_a_file_written_piece_by_piece_is_read_when_it_is_complete(
    run: Simulation, project: Project, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    # on a busy machine, the next piece may come late
    monkeypatch.setattr("morse.simulation.watching.watch._PATIENCE", 60.0)
    content = (DATA / "robots" / "atrv.blend").read_bytes()
    path = project.folder / "data" / "robots" / "mine.blend"
    with path.open("wb") as file:
        for begin in range(0, len(content), len(content) // 4 + 1):
            file.write(content[begin : begin + len(content) // 4 + 1])
            file.flush()
            end = time.monotonic() + 0.3
            step_until(run, lambda end=end: time.monotonic() > end)  # type: ignore[misc]
    step_until(run, lambda: run.world.arrangement)
    assert any("wheel" in name.lower() for name in shown(run))
    assert not [record for record in caplog.records if record.levelname == "ERROR"]


def test_a_thing_that_was_spawned_follows_its_file_and_takes_the_record_with_it(
    run: Simulation, project: Project
) -> None:
    path = project.model("props/box.blend", DATA / "props" / "crates.blend")
    models = len(run.scene.models)
    run.spawn("box", str(path), (4.0, 4.0, 1.0))
    assert len(run.scene.models) == models + 1
    before = run.world.arrangement
    (watch,) = [observer for observer in run.observers if isinstance(observer, Watch)]
    step_until(run, lambda: str(path) in watch._files._stamps)
    project.model("props/box.blend", DATA / "props" / "objects.blend")
    step_until(run, lambda: run.world.arrangement != before)
    assert shown(run, "box")
    run.delete("box")
    assert len(run.scene.models) == models


@pytest.mark.skipif(shutil.which("blender") is None, reason="Blender is not installed")
def test_an_environment_that_is_edited_in_blender(tmp_path: Path) -> None:
    project = Project(tmp_path)
    path = project.model("environments/world.blend", DATA / "environments" / "indoors-1" / "boxes.blend")
    with project.load("robot = ATRV()\nrobot.translate(0, 0, 0.2)\nenv = Environment('world', fastmode=True)\n") as run:
        run.step(30)
        names = {node.name for node in run.scene.nodes()}
        box = next(name for name in sorted(names) if "Box" in name)
        held = run.world.game_object(box)
        script = tmp_path / "edit.py"
        script.write_text(
            textwrap.dedent(
                f"""
                import bpy
                bpy.data.objects.remove(bpy.data.objects[{box!r}])
                bpy.ops.mesh.primitive_cube_add(size=0.5, location=(3.0, 3.0, 4.0))
                bpy.context.object.name = "Novelty"
                bpy.ops.wm.save_mainfile(filepath={os.fspath(path)!r})
                """
            )
        )
        command = ["blender", "-b", "--factory-startup", "-noaudio", os.fspath(path), "--python-exit-code", "3"]
        subprocess.run([*command, "--python", os.fspath(script)], check=True, timeout=120, capture_output=True)
        step_until(run, lambda: run.scene.find("Novelty"))
        assert run.scene.find(box) is None
        with pytest.raises(RemovedError):
            held.worldPosition  # noqa: B018
        assert run.world.game_object("Novelty").worldPosition[2] == pytest.approx(4.0, abs=0.1)
        run.restart()
        assert run.scene.find("Novelty") is not None
        assert run.scene.find(box) is None
