"""The first page of the architecture fits a screen, and the files and functions that it names exist."""

import ast
import re
import socket
import sys
import threading
from pathlib import Path
from types import FrameType

import pytest

import morse
from tests.kit.programs import free_port
from tests.kit.waiting import wait_until

PAGE = (Path(__file__).parents[2] / "docs/architecture.md").read_text(encoding="utf-8")
WAYS = PAGE.partition("## Three ways")[2].partition("\n## ")[0]
SOURCES = Path(morse.__file__).parent
#: lines and columns of a usual window
_LINES, _COLUMNS = 50, 125
#: a file, and the names after it until the next file or the end of the row
_STEP = re.compile(r"\[`([\w/]+\.py)`\]\(\.\./src/morse/([\w/]+\.py)\)")


def names(path: Path) -> set[str]:
    """All classes, functions and methods of a file, as `Class.method`."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    kinds = (ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    found = {node.name for node in tree.body if isinstance(node, kinds)}
    for owner in (node for node in tree.body if isinstance(node, ast.ClassDef)):
        found |= {f"{owner.name}.{node.name}" for node in owner.body if isinstance(node, kinds)}
    return found


def steps() -> list[tuple[list[str], list[str]]]:
    """The files and the names of functions of each row, and of each sentence below a table."""
    texts = [line for line in WAYS.splitlines() if line.startswith("| ")] + re.split(r"(?<=\.)\s", WAYS)[-3:]
    found = []
    for text in texts:
        files = [label for label, _ in _STEP.findall(text)]
        functions = re.findall(r"`((?:[A-Z_]\w*\.)?[a-z_]\w*|[A-Z]\w+(?:\.\w+)?)`", re.sub(r"\[`[^`]*`\]", "", text))
        if files:
            found.append((files, [name for name in functions if name != "local_data"]))
    return found


def test_the_first_page_fits_a_screen() -> None:
    first = PAGE.partition("\n## ")[0].splitlines()
    assert len(first) <= _LINES
    picture = PAGE.partition("```text\n")[2].partition("```")[0].splitlines()
    assert max(map(len, picture)) <= _COLUMNS


def test_there_are_three_ways_of_few_files() -> None:
    ways = WAYS.split("\n**")[1:]
    assert [len(set(_STEP.findall(way.partition("\n\nA [rec")[0].partition("\n\nRobots")[0]))) for way in ways] == [
        pytest.approx(length, abs=2) for length in (12, 8, 13)
    ]


@pytest.mark.parametrize(("files", "functions"), steps())
def test_the_functions_of_a_step_exist_in_its_files(files: list[str], functions: list[str]) -> None:
    assert functions
    known = set().union(*(names(SOURCES / file) for file in files))
    assert set(functions) <= known


@pytest.mark.parametrize(("label", "target"), _STEP.findall(PAGE))
def test_a_link_goes_to_the_file_that_it_names(label: str, target: str) -> None:
    assert label == target
    assert (SOURCES / target).is_file()


SCENE = """
from morse.builder import *
robot = {robot}()
motion = MotionVW()
motion.add_stream("socket", port={port})
robot.append(motion)
env = Environment("empty", fastmode=True)
"""
TAKEN = [
    "LineClient.data_received",
    "StreamClient.line",
    "Ticker.tick",
    "Ticker._actuate",
    "Guard.act",
]
READ = ["Actuator.take_input", "read", "KindStream.default", "SocketReader.arrived", "ClientCommands.take"]
COMMANDED = ["MotionVW.default_action", "LimitedMotion.speeds"]
AS_BODY = [
    *TAKEN,
    "ActuatorRows.action",
    *READ,
    *COMMANDED,
    "Robot.apply_speed",
    "GameObject.drive",
    "Fleet.adopt",
    "Fleet.drive",
    "World.step",
    "Drives.before_step",
    "Fleet.begin",
    "Drives._drive_body",
    "Steps.step",
    "Passage.alone",
]
ON_WHEELS = [
    *TAKEN,
    "Actuator.action",
    *READ,
    *COMMANDED,
    "PhysicsDifferentialRobot.apply_speed",
    "Wheel.set_speed",
    "World.step",
    "Traction.before_step",
    "Drives.before_step",
    "Steps.step",
]


def entered(robot: str, folder: Path) -> list[str]:
    """The functions of MORSE that a command enters, in the order of their first calls."""
    seen: dict[str, None] = {}
    is_on = threading.Event()

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and is_on.is_set() and frame.f_code.co_filename.startswith(str(SOURCES)):
            seen.setdefault(frame.f_code.co_qualname)

    port, script = free_port(), folder / "scene.py"
    script.write_text(SCENE.format(robot=robot, port=port))
    threading.setprofile(note)  # the network thread begins after it
    try:
        with morse.load(script, sockets=True) as simulation:
            simulation.step(20)
            is_on.set()
            with socket.create_connection(("127.0.0.1", port), 60.0) as client:
                # a message waits for a tick if it arrives in the one in which its client was accepted
                wait_until(lambda: "StreamClient.connection_made" in seen)
                simulation.step(2)
                seen.clear()
                client.sendall(b'{"v": 1.0}\n')
                wait_until(lambda: "StreamClient.line" in seen)
                sys.setprofile(note)
                simulation.step(60)
                sys.setprofile(None)
                is_on.clear()
            assert simulation.robot.motion.component.local_data["v"] == 1.0
    finally:
        sys.setprofile(None)
        threading.setprofile(None)
    return list(seen)


@pytest.mark.parametrize(("robot", "way"), [("ATRV", AS_BODY), ("SegwayRMP400", ON_WHEELS)])
def test_a_command_goes_the_way_of_the_page(robot: str, way: list[str], tmp_path: Path) -> None:
    assert [name for name in entered(robot, tmp_path) if name in way] == way
    first = WAYS.partition("**A joint")[0]
    assert not [name for name in way if f"`{name}`" not in first]


def test_all_functions_of_the_first_way_exist() -> None:
    way = WAYS.partition("**A joint")[0]
    known = set().union(*(names(SOURCES / file) for _, file in _STEP.findall(way)))
    assert not set(re.findall(r"`(\w+\.[a-z_]\w*)`", way)) - known
