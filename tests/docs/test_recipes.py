"""The recipes do what they say."""

import logging
import re
import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import recipe_programs
import recipe_scenes
from doc_pages import DOCS
from recipe_programs import Done

import morse
from morse.simulation.simulation import Simulation

PAGE = (DOCS / "recipes.md").read_text(encoding="utf-8")
RECIPES = dict(re.findall(r"^## (.*?)\n.*?```python\n(.*?)```", PAGE, re.DOTALL | re.MULTILINE))
TEST = "A test of a robot"
#: recipes of some seconds
LONG = ("A run as a web page", "An hour in seconds", "Sixteen robots at once, as arrays")
PROGRAMS = [pytest.param(name, marks=pytest.mark.slow if name in LONG else ()) for name in recipe_programs.CHECKS]


def test_every_recipe_is_checked_and_short() -> None:
    assert RECIPES.keys() == recipe_scenes.CHECKS.keys() | recipe_programs.CHECKS.keys() | {TEST}
    for name, text in RECIPES.items():
        lines = [line for line in text.splitlines() if line.strip()]
        assert len(lines) <= (14 if name in recipe_scenes.CHECKS else 24), name
    files = re.findall(r"\((pictures/recipes/.*?)\)", PAGE)
    assert len(files) == len(RECIPES)
    for file in files:
        assert (DOCS / file).stat().st_size <= 60_000


@pytest.mark.parametrize("name", recipe_scenes.CHECKS)
def test_a_scene_does_what_it_says(name: str, tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(RECIPES[name], encoding="utf-8")
    with morse.load(script, on_warning="raise") as sim:
        recipe_scenes.CHECKS[name](sim)


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_program_does_what_it_says(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    caplog: pytest.LogCaptureFixture,
) -> None:
    places: dict[str, list[float]] = {}
    close = Simulation.close

    def noted(simulation: Any) -> None:
        places.update({body.name: list(body.worldPosition) for body in simulation.world.objects()})
        close(simulation)

    monkeypatch.setattr(Simulation, "close", noted)
    monkeypatch.chdir(tmp_path)
    script = tmp_path / "recipe.py"
    script.write_text(RECIPES[name], encoding="utf-8")
    if "morse.gym" in RECIPES[name]:
        pytest.importorskip("gymnasium")
    names = runpy.run_path(str(script), run_name="__main__")
    output, noise = capsys.readouterr()
    recipe_programs.CHECKS[name](Done(names, tmp_path, places, output))
    assert output or len(list(tmp_path.iterdir())) > 1, "a program shows what it has done"
    assert not noise
    assert not [record.getMessage() for record in caplog.records if record.levelno >= logging.WARNING]


def test_a_test_passes(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text('pytest_plugins = ["morse.testing.fixtures"]\n', encoding="utf-8")
    (tmp_path / "test_drive.py").write_text(RECIPES[TEST], encoding="utf-8")
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert "2 passed" in done.stdout, done.stdout + done.stderr
