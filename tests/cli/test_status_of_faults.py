"""A run in which a part was switched off by a fault says so in its exit status, and in its last lines."""

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
import yaml

from morse.simulation.ending import FAULTS
from morse.testing.process import SimulationProcess
from pymorse import Morse
from tests.kit.programs import python

pytestmark = pytest.mark.long

PARTS = """
import threading
from morse.core.actuator import Actuator
from morse.core.modifier import AbstractModifier
from morse.core.sensor import Sensor
from morse.helpers.components import add_data
from morse.middleware.text_datastream import Publisher
from morse.robots.fakerobot import FakeRobot


class Counter(Sensor):
    add_data("count", 0, "int", "Number of measurements")

    def default_action(self):
        self.local_data["count"] += 1


class AtOnce(Counter):
    def default_action(self):
        raise ValueError("no echo")  # at once


class Later(Counter):
    def default_action(self):
        super().default_action()
        if self.local_data["count"] > 6:
            raise RuntimeError("tired")  # later


class AtTheEnd(Counter):
    def finalize(self):
        super().finalize()
        raise OSError("no paper")  # at the end


class Threaded(Counter):
    def default_action(self):
        super().default_action()
        if self.local_data["count"] == 3:
            thread = threading.Thread(target=self.listen, name="ears")
            thread.start()
            thread.join()

    def listen(self):
        raise KeyError("ear")  # thread


class Leaves(Counter):
    def default_action(self):
        raise SystemExit


class Jammed(Actuator):
    add_data("torque", 0.0, "float", "Torque", unit="N·m")

    def default_action(self):
        raise ZeroDivisionError("jammed")  # actuator


class Sleepy(FakeRobot):
    def default_action(self):
        raise LookupError("where")  # robot


class Spoils(AbstractModifier):
    def modify(self):
        raise TypeError("spoiled")  # modifier


class Torn(Publisher):
    def encode_data(self):
        raise BufferError("torn")  # stream
"""

SCENE = """
from morse.builder import *
from parts import *
robot = {robot}()
{lines}
robot.add_default_interface("socket")
env = Environment("empty", fastmode=True{options})
"""


class Outcome(NamedTuple):
    status: int
    text: str

    def named(self, title: str = "switched off by faults in this run:") -> list[str]:
        """The lines below a title, one for each part."""
        _, _, rest = self.text.partition(f"{title}\n")
        lines: list[str] = []
        for line in rest.splitlines():
            if not line.startswith("  "):
                break
            lines.append(line.strip())
        return lines


@pytest.fixture
def scene(tmp_path: Path) -> Callable[..., Path]:
    (tmp_path / "parts.py").write_text(PARTS)

    def write(*lines: str, robot: str = "FakeRobot", options: str = "") -> Path:
        path = tmp_path / "scene.py"
        path.write_text(SCENE.format(lines="\n".join(lines), robot=robot, options=options))
        return path

    return write


def _morse(*words: object, command: str = "run") -> Outcome:
    options = ("--headless", "--speed", "max", "--keep-last", "0") if command == "run" else ()
    process = subprocess.run(
        [sys.executable, "-m", "morse", command, *options, *map(str, words)],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=120,
        cwd=next((word.parent for word in words if isinstance(word, Path)), None),
        env={**os.environ, "MORSE_SOCKET_PORT": "0"},
    )
    return Outcome(process.returncode, process.stdout)


def _line_of(mark: str) -> int:
    return next(number for number, line in enumerate(PARTS.splitlines(), 1) if line.endswith(f"# {mark}"))


#: lines of the scene, the robot; the part, what follows, the error and the comment of the line that raised it
KINDS = {
    "first tick": (
        "a = AtOnce(); robot.append(a)",
        "robot.a failed and is deactivated: ValueError: no echo",
        "at once",
    ),
    "in the middle": (
        "a = Later(); robot.append(a)",
        "robot.a failed and is deactivated: RuntimeError: tired",
        "later",
    ),
    "end": ("a = AtTheEnd(); robot.append(a)", "robot.a failed and ended: OSError: no paper", "at the end"),
    "thread": (
        "a = Threaded(); robot.append(a)",
        "the thread ears of robot.a failed and has ended: KeyError: 'ear'",
        "thread",
    ),
    "actuator": (
        "a = Jammed(); robot.append(a)",
        "robot.a failed and is deactivated: ZeroDivisionError: jammed",
        "actuator",
    ),
    "modifier": (
        "a = Pose(); a.alter('', classpath='parts.Spoils'); robot.append(a)",
        "the modifier Spoils of robot.a failed and robot.a is deactivated, because its data are not modified: "
        "TypeError: spoiled",
        "modifier",
    ),
}


def test_one_line_for_each_part(scene: Callable[..., Path]) -> None:
    lines = [line.replace("a = ", f"a{n} = ").replace("a.", f"a{n}.").replace("(a)", f"(a{n})")
             for n, (line, _, _) in enumerate(KINDS.values())]  # fmt: skip
    outcome = _morse("--duration", "0.5", scene(*lines))
    assert outcome.status == FAULTS == 3, outcome.text
    named = outcome.named()
    assert len(named) == len(KINDS)
    for number, (_, words, mark) in enumerate(KINDS.values()):
        (line,) = [one for one in named if words.replace("robot.a", f"robot.a{number}") in one]
        assert line.endswith(f"parts.py:{_line_of(mark)})")
        assert re.match(r"at 0\.\d{3} s ", line)
    assert "at 0.117 s robot.a1" in outcome.text, "in its seventh tick of 1/60 s"
    assert outcome.text.rindex("switched off") < outcome.text.rindex("EXITING SIMULATION"), "programs wait for it"


@pytest.mark.parametrize("kind", ["first tick", "end"])
def test_one_part_is_enough(scene: Callable[..., Path], kind: str) -> None:
    line, words, _ = KINDS[kind]
    path = scene(line)
    outcome = _morse("--duration", "0.1", path)
    assert outcome.status == FAULTS
    (named,) = outcome.named()
    assert words in named
    kept = _morse("--duration", "0.1", "--keep-going", path)
    assert (kept.status, len(kept.named())) == (0, 1), "it is still named"


def test_streams_and_robots(scene: Callable[..., Path]) -> None:
    torn = "a = Counter(); robot.append(a); a.add_stream('text', 'parts.Torn'); a.add_stream('text', file='all.txt')"
    path = scene(torn, robot="Sleepy")
    outcome = _morse("--duration", "0.1", path)
    assert outcome.status == FAULTS
    assert any("robot failed and is deactivated: LookupError: where" in line for line in outcome.named())
    (line,) = [
        one for one in outcome.named() if "the stream Torn of robot.a failed and is closed: BufferError: torn" in one
    ]
    assert line.endswith(f"parts.py:{_line_of('stream')})")
    assert len((path.parent / "all.txt").read_text().splitlines()) > 3, "the other stream goes on"


def test_a_run_without_faults(scene: Callable[..., Path]) -> None:
    outcome = _morse("--duration", "0.1", scene("a = Counter(); robot.append(a)"))
    assert (outcome.status, outcome.named()) == (0, []), outcome.text
    assert "switched off" not in outcome.text


def test_what_ends_the_program_hides_no_fault(scene: Callable[..., Path]) -> None:
    fault = "a = AtOnce(); robot.append(a); b = Leaves(); b.frequency(6); robot.append(b)"
    assert _morse("--duration", "1", scene(fault)).status == FAULTS
    assert _morse("--duration", "1", scene("b = Leaves(); robot.append(b)")).status == 0


def test_a_fault_counts_after_a_restart_and_while_paused(scene: Callable[..., Path], tmp_path: Path) -> None:
    path = scene("a = Later(); robot.append(a)")
    process = SimulationProcess(path, tmp_path / "log", options=["--headless", "--keep-last", "0"])
    process.wait_initialized()
    with Morse("127.0.0.1", process.port) as simulation:
        simulation.rpc("simulation", "pause")
        simulation.rpc("simulation", "step", 30)
        simulation.rpc("simulation", "reset")
        assert simulation.robot.a.get_local_data().result()["count"] < 7, "it lives again"
        simulation.quit()
    process.watch.join(60)
    assert process._process.wait(60) == FAULTS
    (line,) = Outcome(0, process.log.read_text()).named()
    assert "robot.a failed and is deactivated" in line


EDITED = """
import math, sys
from pathlib import Path
from morse.core.reports import log
from morse.launch.run import run
from morse.simulation.options import RunOptions

script = Path(sys.argv[1])

def ready(simulation):
    def edit():
        if simulation.ticks == 20:
            script.write_text(script.read_text().replace("Later", "Counter"))
            simulation.start_anew()
    simulation.before_physics.append(edit)

log.setup()
options = RunOptions(script=str(script), view="none", sockets=False, watch=True, speed=math.inf, duration=0.5)
sys.exit(run(options, ready))
"""


def test_a_fault_counts_after_the_scene_was_edited(scene: Callable[..., Path], tmp_path: Path) -> None:
    path = scene("a = Later(); robot.append(a)")
    (tmp_path / "edited.py").write_text(EDITED)
    done = python("edited.py", path, folder=tmp_path)
    outcome = Outcome(done.returncode, done.stdout)
    assert outcome.status == FAULTS, outcome.text + done.stderr
    assert "read again: " in outcome.text
    assert len(outcome.named()) == 1, "that of the scene before"


@pytest.mark.parametrize("command", ["verify", "render"])
def test_other_commands(scene: Callable[..., Path], tmp_path: Path, command: str) -> None:
    options = ("--ticks", "20") if command == "verify" else ("--size", "32x24", "-o", tmp_path / "picture.png")
    outcome = _morse(scene("a = Later(); robot.append(a)"), *options, command=command)
    assert outcome.status == FAULTS
    assert "robot.a failed and is deactivated: RuntimeError: tired" in outcome.text
    assert ("Repeatable" in outcome.text) == (command == "verify")
    assert (tmp_path / "picture.png").exists() == (command == "render"), "it has done its work nevertheless"


# -- robots that leave the world ------------------------------------------------------------------------

FALLS = "off = ATRV(); off.translate(21, 0, 0.1)"
LEFT = "robots that have left the world in this run:"


def test_a_fall_is_told_and_ends_the_run_if_the_scene_says_so(scene: Callable[..., Path]) -> None:
    outcome = _morse("--duration", "2.5", scene(FALLS))
    assert outcome.status == 0
    (line,) = outcome.named(LEFT)
    assert re.fullmatch(r"at 1\.\d{3} s off has left the world: it is at z = -1\d\.\d m, .* \(.*scene\.py:5\)", line)
    assert outcome.text.count("off falls: it is at z = -") == 1
    strict = scene(FALLS, options=', fallen="error"')
    outcome = _morse("--duration", "1000", strict)
    assert outcome.status == FAULTS
    assert "[ERROR][MORSE] off has left the world: it is at z = -1" in outcome.text
    assert "[ERROR][MORSE] robots that have left the world" in outcome.text
    assert len(outcome.named(LEFT)) == 1
    kept = _morse("--duration", "2.5", "--keep-going", strict)
    assert (kept.status, len(kept.named(LEFT))) == (0, 1)
    assert "[ERROR]" not in kept.text


# -- the step of the page on CI ---------------------------------------------------------------------------

DRIVER = """
from pymorse import Morse
with Morse() as simulation:
    simulation.sleep(0.5)
raise SystemExit({status})
"""


@pytest.mark.skipif(os.name != "posix", reason="it is for bash")
@pytest.mark.parametrize(
    ("lines", "driver", "status"),
    [("a = Counter(); robot.append(a)", 0, 0), (KINDS["in the middle"][0], 0, FAULTS), ("", 5, 5)],
)
def test_the_step_of_the_documentation(
    scene: Callable[..., Path], tmp_path: Path, lines: str, driver: int, status: int
) -> None:
    page = (Path(__file__).parents[2] / "docs/ci.md").read_text(encoding="utf-8")
    (jobs,) = [yaml.safe_load(text.partition("```")[0]) for text in page.split("```yaml\n")[1:] if "driver.py" in text]
    (step,) = [one["run"] for one in jobs["jobs"]["drive"]["steps"] if "driver.py" in one.get("run", "")]
    here = "until grep -qs INITIALIZED run.log; do sleep 0.1; done; timeout 300 python3"
    for before, after in {
        ". /opt/ros/$ROS_DISTRO/setup.sh\n": "",
        "/morse/bin/morse run --headless --ros2": f"{sys.executable} -m morse run --headless --keep-last 0",
        "rover.py &": "rover.py > run.log &",
        "timeout 300 python3": here.replace("python3", sys.executable),
    }.items():
        assert before in step
        step = step.replace(before, after)
    scene(lines).rename(tmp_path / "rover.py")
    (tmp_path / "driver.py").write_text(DRIVER.format(status=driver))
    done = subprocess.run(
        ["bash", "-e", "-c", step], cwd=tmp_path, capture_output=True, text=True, timeout=200, check=False
    )
    said = done.stdout + done.stderr + (tmp_path / "run.log").read_text()
    assert done.returncode == status, said
    assert ("robot.a failed and is deactivated: RuntimeError: tired" in said) == (status == FAULTS)
    assert (tmp_path / "run.mcap").stat().st_size > 0
