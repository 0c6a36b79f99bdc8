"""`morse verify` names differences."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from morse.cli.app import execute
from morse.simulation.options import RunOptions
from morse.verification.verify import Difference, ReplayError, verify
from tests.kit.waiting import wait_until

pytestmark = pytest.mark.long

SCENE = """
import sys
sys.path.insert(0, {here!r})
from morse.builder import *
from morse.builder.creator import SensorCreator

class Honest(SensorCreator):
    _classpath = "verification_parts.Fair"

class Eye(SensorCreator):
    _classpath = "verification_parts.{component}"

robot = ATRV()
honest = Honest()
robot.append(honest)
eye = Eye()
robot.append(eye)
env = Environment("empty", fastmode=True)
"""


def scene(tmp_path: Path, component: str) -> str:
    path = tmp_path / "scene.py"
    path.write_text(SCENE.format(here=str(Path(__file__).parent), component=component), encoding="utf-8")
    return str(path)


def differences(tmp_path: Path, component: str, ticks: int) -> list[Difference]:
    return verify(RunOptions(scene(tmp_path, component)), ticks, clients=0)


@pytest.mark.parametrize(
    ("component", "part", "tick"),
    [
        # as `test_the_command_says_what_differs`
        pytest.param("WallClock", "robot.eye", 5, marks=pytest.mark.slow),
        ("Dice", "robot.eye", 60),
        ("Shaky", "physics", 7),
    ],
)
def test_the_first_tick_and_component_that_differ_are_named(
    tmp_path: Path, component: str, part: str, tick: int
) -> None:
    found = differences(tmp_path, component, 70)
    assert [(d.part, d.tick) for d in found] == [(part, tick)] * 2


def test_what_only_a_restart_shows(tmp_path: Path) -> None:
    (found,) = differences(tmp_path, "Memory", 20)
    assert (found.part, found.tick) == ("robot.eye", 8)
    assert "restart" in found.runs


def test_what_only_another_process_shows(tmp_path: Path) -> None:
    (found,) = differences(tmp_path, "Sets", 20)
    assert (found.part, found.tick) == ("robot.eye", 3)
    assert "two processes" in found.runs


def test_data_that_no_encoder_knows_can_be_compared(tmp_path: Path) -> None:
    assert differences(tmp_path, "Unwritable", 10) == []


def test_the_command_says_what_differs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(["verify", "--ticks", "10", scene(tmp_path, "WallClock")]) == 1
    err = capsys.readouterr().err
    assert "tick 5" in err
    assert "'robot.eye'" in err


def test_equal_runs_and_options_that_follow_the_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(["verify", scene(tmp_path, "Fair"), "--ticks", "7"]) == 0
    said = capsys.readouterr()
    assert "7 ticks are equal" in said.out + said.err


def test_a_scene_that_is_none(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "broken.py"
    path.write_text("from morse.builder import *\nrobot = ATRVV()\n")
    with pytest.raises(ReplayError, match="ATRVV"):
        verify(RunOptions(str(path)), 5)
    assert execute(["verify", "--ticks", "5", str(path)]) == 1
    assert "ATRVV" in capsys.readouterr().err


HEAD = "from morse.builder import *\n\n"


@pytest.mark.parametrize(
    ("body", "line", "answer"),
    [
        ("robot = ATRVV()", 3, "Did you mean 'ATRV'?"),
        ("robot = ATRV(", 3, "SyntaxError: '(' was never closed"),
        ("robot = ATRV()\nrobot.alter('Nope')", 4, "there is no modifier 'Nope'"),
        ("1 / 0", 3, "ZeroDivisionError: division by zero"),
        ("import sys\nsys.exit(3)", 4, "the script ended with sys.exit(3)"),
    ],
)
def test_a_mistake_in_a_scene_is_named_with_its_line_as_by_morse_run(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], body: str, line: int, answer: str
) -> None:
    path = tmp_path / "faulty.py"
    path.write_text(HEAD + body + "\n")
    assert execute(["verify", "--ticks", "5", str(path)]) == 1
    error = capfd.readouterr().err
    assert f"{path}:{line}" in error
    assert answer in error
    assert "Traceback" not in error


@pytest.mark.parametrize("ticks", ["0", "-5", "many", "1.5", "nan"])
def test_numbers_of_ticks_that_are_none(tmp_path: Path, ticks: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(["verify", f"--ticks={ticks}", scene(tmp_path, "Fair")]) == 2
    assert "--ticks" in capsys.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="processes are asked after by their numbers")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_nothing_is_left_of_a_command_that_was_killed(tmp_path: Path, number: int) -> None:
    script, told = tmp_path / "scene.py", tmp_path / "told"
    script.write_text(
        "import os, pathlib\nfrom morse.builder import *\n"
        f"pathlib.Path({str(told)!r}).write_text(str(os.getpid()) + '.')\n"
        "robot = FakeRobot()\nenv = Environment('empty', fastmode=True)\n"
    )
    folder = tmp_path / "temporary"
    folder.mkdir()
    command = [sys.executable, "-m", "morse", "verify", "--ticks", "10000000", str(script)]
    with subprocess.Popen(command, env={**os.environ, "TMPDIR": str(folder)}, stdout=subprocess.DEVNULL) as process:
        child = int(wait_until(lambda: told.exists() and told.read_text().endswith(".") and told.read_text())[:-1])
        os.kill(process.pid, number)
        process.wait(60)
    wait_until(lambda: not _lives(child))
    assert list(folder.iterdir()) == []


def _lives(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    # a finished process stays in the table until its parent waits for it
    state = Path(f"/proc/{pid}/stat")
    return not (state.exists() and state.read_text().rpartition(")")[2].split()[0] == "Z")


def test_what_a_scene_prints_and_reads_does_not_disturb(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(
        "import sys\nfrom morse.builder import *\nprint('not JSON'); assert sys.stdin.read() == ''\n"
        "robot = FakeRobot()\nenv = Environment('empty', fastmode=True)\n"
    )
    assert verify(RunOptions(str(script)), 5, clients=0) == []
