"""The types of scene scripts for editors and type checkers."""

import importlib.util
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]
BLOCKS = ROOT / "tests" / "journey" / "blocks"

WRONG = """\
from morse.builder import *
robot = Morsy()
robot.tanslate(1.0)
pose = Posee()
scanner = Sick()
scanner.create_laser_arc()
scanner.properties(resolution="fine")
scanner.create_laser_arcs()
env = Environment("empty", fastmode=False)
env.set_gravty(1.0)
"""
MISTAKES = {
    3: '"Morsy" has no attribute "tanslate"',
    4: 'Name "Posee" is not defined',
    7: 'Argument "resolution" to "properties" of "Sick" has incompatible type "str"',
    8: '"Sick" has no attribute "create_laser_arcs"',
    10: '"Environment" has no attribute "set_gravty"',
}


@pytest.fixture(scope="module")
def tool() -> ModuleType:
    """The program that writes the stubs."""
    spec = importlib.util.spec_from_file_location("builder_stubs", ROOT / "tools" / "stubs" / "builder_stubs.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def mypy(folder: Path, *files: str) -> str:
    """The output of mypy for files of a user."""
    (folder / "mypy.ini").write_text(
        f"[mypy]\nmypy_path = {ROOT / 'src'}:{folder / 'src'}\ncheck_untyped_defs = True\nfollow_imports = silent\n"
        # the file that imports another one of the project
        "namespace_packages = True\n"
    )
    command = [sys.executable, "-m", "mypy", "--config-file", "mypy.ini", "--cache-dir", str(folder / "cache"), *files]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=110, check=False)
    assert done.returncode in (0, 1), done.stdout + done.stderr
    return done.stdout


def test_stubs_are_what_the_declarations_say(tool: ModuleType) -> None:
    for name, text in tool.stubs().items():
        written = (tool.FOLDER / name).read_text(encoding="utf-8")
        assert written == text, f"{name} is out of date: run `python -m tools stubs`"


def test_the_stub_has_every_name_of_the_star_import(tool: ModuleType) -> None:
    given: dict[str, object] = {}
    exec("from morse.builder import *", given)
    stub: dict[str, object] = {}
    exec(tool.stubs()["__init__.pyi"].replace("logger: logging.Logger", "logger = None"), stub)
    assert set(given) - set(stub) == set()


@pytest.mark.slow
def test_mypy_knows_the_scene_of_the_tutorial(tmp_path: Path) -> None:
    robots = tmp_path / "src" / "ranger_sim" / "builder" / "robots"
    robots.mkdir(parents=True)
    for folder in (robots, robots.parent, robots.parent.parent):
        (folder / "__init__.py").write_text("")
    template = ROOT / "src/morse/data/templates/robot/src/@env@/builder/robots/@name@.py.tpl"
    ranger = template.read_text().replace("@env@", "ranger_sim").replace("@name@", "ranger")
    (robots / "ranger.py").write_text(ranger.replace("@classname@", "Ranger"))
    (robots / "__init__.py").write_text("from .ranger import Ranger\n")
    (tmp_path / "default.py").write_text((BLOCKS / "default.py").read_text())
    (tmp_path / "wrong.py").write_text(WRONG)
    said = mypy(tmp_path, "default.py", "wrong.py")
    lines = {int(line.split(":")[1]): line for line in said.splitlines() if line.startswith("wrong.py:")}
    assert "default.py" not in said
    assert "ranger.py" not in said
    assert set(lines) == set(MISTAKES)
    for number, text in MISTAKES.items():
        assert text in lines[number]
