"""The chapters on new components: their files are complete, their tests pass, and the components keep the contract."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from doc_pages import DOCS

from morse.cli.app import execute

pytestmark = pytest.mark.long

#: the line before a block of code that is a file: its path
_FILE = re.compile(r"`([\w./]+)`:\n\n```\w+\n(.*?)^```$", re.MULTILINE | re.DOTALL)
CHAPTERS = sorted(path.stem for path in DOCS.glob("new-*.md"))


def files_of(chapter: str) -> dict[str, str]:
    """The files that a chapter shows, by path in the project."""
    return dict(_FILE.findall((DOCS / f"{chapter}.md").read_text(encoding="utf-8")))


@pytest.fixture
def project(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A new project, as `morse create` writes it."""
    for variable in ("HOME", "USERPROFILE"):
        monkeypatch.setenv(variable, str(tmp_path))
    monkeypatch.chdir(tmp_path)
    assert execute(["create", "my_sim"]) == 0
    (tmp_path / "my_sim" / "tests" / "test_default.py").unlink()
    return tmp_path / "my_sim"


def run(project: Path, *command: str) -> subprocess.CompletedProcess[str]:
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}
    return subprocess.run(
        [sys.executable, *command],
        cwd=project,
        env=environment,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )


def write(project: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = project / name
        path.parent.mkdir(parents=True, exist_ok=True)
        before = path.read_text(encoding="utf-8") if name == "pyproject.toml" else ""
        path.write_text(before + text, encoding="utf-8")


def test_there_is_a_chapter_for_each_kind():
    kinds = {"sensor", "actuator", "robot", "modifier", "model-format", "service", "check", "command"}
    assert {f"new-{kind}" for kind in kinds} <= set(CHAPTERS)


@pytest.mark.parametrize("chapter", CHAPTERS)
def test_the_test_of_the_chapter_passes(project: Path, chapter: str):
    write(project, files_of(chapter))
    done = run(project, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:xdist", "tests")
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^\d+ passed", done.stdout, re.MULTILINE)


COMPONENTS = [
    pytest.param(chapter, name, id=Path(name).stem)
    for chapter in CHAPTERS
    for name in files_of(chapter)
    if name.startswith(("src/my_sim/sensors/", "src/my_sim/actuators/"))
]


@pytest.mark.parametrize(("chapter", "name"), COMPONENTS)
def test_the_component_keeps_the_contract(project: Path, chapter: str, name: str):
    write(project, files_of(chapter))
    done = run(project, "-m", "morse", "check", "component", name)
    assert done.returncode == 0, done.stdout + done.stderr
