"""A script that is saved while the simulation starts counts as edited."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

from morse.builder.script import load_scene
from morse.launch.rereading import Rereading, script_stamp, source_stamps
from morse.simulation.options import RunOptions

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
