"""Takes the pictures of the documentation from real simulations: follows the tutorial, and looks.

    python docs/pictures/make.py [NAME ...]

Needs what the tests of the tutorial need: MORSE installed, Chromium, Blender. Without names, makes all.
"""

from __future__ import annotations

import contextlib
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pexpect
from studio import Studio, beside, save

import morse
import pymorse

# whoever tests the tutorial also takes its pictures
sys.path.append(str(Path(__file__).parents[2] / "tests" / "journey"))
from steps import Person, block, wait_for

if TYPE_CHECKING:
    from collections.abc import Iterator

    from steps import Running

CRATES = Path(morse.__file__).parent / "data" / "props" / "crates.blend"
#: in the simulated world, metres: where the ranger of the tutorial stands
START = (1.0, 0.0)
ROBOTS = """
from morse.builder import *

{robots}
env = Environment("empty")
"""


class Journey:
    """The tutorial, as far as a picture needs it."""

    def __init__(self, folder: Path) -> None:
        self.person = Person(folder)
        self.project = self.person.project
        self.person.types("create", "ranger_sim")

    def own_robot(self) -> None:
        """Chapter two: the ranger, a crate with eyes."""
        self.person.types("add", "robot", "ranger", "ranger_sim")
        (self.project / "default.py").write_text(block("default.py"))
        self.person.edits("edit_ranger.py", self.project / "data/ranger_sim/robots/ranger.blend", str(CRATES))

    def own_actuator(self) -> None:
        """Chapter four: its eyes move."""
        self.person.types("add", "actuator", "eyes", "ranger_sim", answer="Controls the eyes of the ranger\n")
        builder = self.project / "src/ranger_sim/builder/robots/ranger.py"
        lines = block("builder_lines.py").splitlines()
        at = "        self.append(self.motion)\n"
        added = at + "".join(f"        {line}\n" for line in lines)
        builder.write_text(block("builder_import.py") + builder.read_text().replace(at, added))
        (self.project / "src/ranger_sim/actuators/eyes.py").write_text(block("eyes.py"))

    @contextlib.contextmanager
    def running(self, scene: str = "ranger_sim") -> Iterator[tuple[Running, pymorse.Morse]]:
        """The simulation and a connection to it."""
        running = self.person.runs("--view-port", "0", "--no-browser", scene)
        port = next((int(line.rpartition("=")[2].rstrip(")")) for line in running.lines if "Morse(port=" in line), 4000)
        with pymorse.Morse(port=port) as simulation:
            yield running, simulation
        running.stop()

    def client(self, name: str, port: int) -> pexpect.spawn:
        """A program of the tutorial in a terminal."""
        script = self.project / "scripts" / "keyboard_ctrl.py"
        # the tutorial has the machine for itself; here another simulation may run
        script.write_text(block(name).replace("Morse()", f"Morse(port={port})"))
        return pexpect.spawn(sys.executable, [str(script)], cwd=str(self.person.folder), encoding="utf-8", timeout=20)


def morsy(journey: Journey) -> None:
    """The first run."""
    with journey.running() as (running, simulation), Studio() as studio:
        studio.watch(running.url)
        studio.page.keyboard.down("ArrowUp")
        wait_for(lambda: simulation.robot.pose.get()["x"] < -0.5, "Morsy to drive")
        studio.page.keyboard.up("ArrowUp")
        save("morsy", [studio.still(simulation)])


def keys(journey: Journey) -> None:
    """The list of all keys."""
    with journey.running() as (running, simulation), Studio() as studio:
        studio.watch(running.url)
        studio.page.keyboard.press("h")
        save("keys", [studio.still(simulation)])


def ranger(journey: Journey) -> None:
    """A robot of one's own: before it has an actuator for the eyes."""
    journey.own_robot()
    with journey.running() as (running, simulation), Studio() as studio:
        studio.watch(running.url)
        studio.look((4.6, -2.6, 2.0), (1.0, 0.15, 0.5))
        save("ranger", [studio.still(simulation)])


def controller(journey: Journey) -> None:
    """A program drives the ranger."""
    journey.own_robot()
    with journey.running() as (running, simulation), Studio(800, 600) as studio:
        studio.watch(running.url)
        terminal = journey.client("keyboard_second.py", simulation.port)
        said = "$ python3 ranger_sim/scripts/keyboard_ctrl.py\n"
        for key in "wwwa":
            said += _hear(terminal, "WASD?") + f"WASD?{key}\n"
            terminal.sendline(key)
            time.sleep(0.3)
        wait_for(lambda: simulation.robot.pose.get()["x"] > START[0] + 2.0, "the ranger to drive")
        said += _hear(terminal, "\n", lines=14)
        pose = simulation.robot.pose.get()
        studio.look((pose["x"] + 3.4, pose["y"] - 2.6, 1.9), (pose["x"] - 0.6, pose["y"], 0.4))
        view = studio.still(simulation)
        terminal.close()
        save("controller", [beside(view, studio.terminal(said, 560, view.height))])


def _hear(terminal: pexpect.spawn, prompt: str, lines: int = 3) -> str:
    """The last lines that a program has printed up to a prompt."""
    terminal.expect_exact(prompt)
    heard = terminal.before.replace("\r", "").splitlines()[-lines:]
    return "".join(line + "\n" for line in heard if line.strip())


def eyes(journey: Journey) -> None:
    """The eyes move: a film."""
    journey.own_robot()
    journey.own_actuator()
    frames = []
    with journey.running() as (running, simulation), Studio(640, 400) as studio:
        studio.watch(running.url)
        studio.look((4.4, -0.9, 1.5), (1.5, 0.0, 0.62))
        simulation.rpc("simulation", "pause")
        for turn in (0.0, 0.5, 1.0, 1.5, 1.0, 0.5, 0.0, -0.5, -1.0, -1.5, -1.0, -0.5):
            simulation.robot.eyes.publish({"left": turn, "right": turn})
            time.sleep(0.2)
            simulation.rpc("simulation", "step", 3)
            frames.append(studio.shot())
    save("eyes", frames, 160)


#: name of a class to where it stands (x, y, z) and its heading
_PLACES = {
    "Hummer": (-3.2, 3.4, 0.9, -0.9),
    "RMax": (-3.0, -0.6, 1.5, 0.7),
    "Submarine": (-3.4, -4.2, 1.0, 0.6),
    "Quadrotor": (3.3, 2.0, 0.1, -0.4),
    "QUAD2012": (1.4, -0.9, 1.9, 0.3),
    "SegwayRMP400": (1.2, 2.5, 0.3, -0.5),
    "ATRV": (0.7, -0.7, 0.1, 0.4),
    "Jido": (0.3, -1.9, 0.0, 0.2),
    "B21": (2.6, 1.1, 0.0, -0.2),
    "Victim": (2.0, -2.7, 0.0, 0.4),
    "Morsy": (2.7, 0.3, 0.0, -0.1),
    "PatrolBot": (3.0, -0.7, 0.2, 0.1),
    "Pioneer3DX": (3.1, -1.5, 0.1, 0.3),
}


def robots(journey: Journey) -> None:
    """All robots."""
    lines = []
    for name, (x, y, z, heading) in _PLACES.items():
        robot = name.lower()
        lines.append(f"{robot} = {name}()\n{robot}.translate({x}, {y}, {z})\n{robot}.rotate(z={heading})")
    scene = journey.person.folder / "robots.py"
    scene.write_text(ROBOTS.format(robots="\n".join(lines)))
    with journey.running(str(scene)) as (running, simulation), Studio() as studio:
        studio.watch(running.url)
        studio.look((8.6, -0.3, 2.9), (0.0, -0.15, 0.75))
        save("robots", [studio.still(simulation)])


PICTURES = {made.__name__: made for made in (morsy, keys, ranger, controller, eyes, robots)}


def main(names: list[str]) -> None:
    """Make the pictures of these names, or all."""
    for name in names or PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            PICTURES[name](Journey(Path(folder)))
        print(f"made {name}.webp")


if __name__ == "__main__":
    main(sys.argv[1:])
