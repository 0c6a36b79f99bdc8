"""Create the pictures of the documentation from real simulations that follow the tutorial.

    python docs/pictures/make.py [NAME ...]

Needs the same programs as the tests of the tutorial: MORSE, Chromium, Blender. Without names, all pictures are created.
"""

from __future__ import annotations

import contextlib
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

import heat
import pexpect
from PIL import Image
from studio import Studio, beside, save

import morse
import pymorse

# the run of the documentation is that of its front page
sys.path.append(str(Path(__file__).parents[1]))
from tour import write_page

# the modules of the tests of the tutorial are used here, too
sys.path.append(str(Path(__file__).parents[2] / "tests" / "journey"))
from steps import Person, block, wait_for

if TYPE_CHECKING:
    from collections.abc import Iterator

    from steps import Running

CRATES = Path(morse.__file__).parent / "data" / "props" / "crates.blend"
#: position of the ranger of the tutorial in the world, metres
START = (1.0, 0.0)
ROBOTS = """
from morse.builder import *

{robots}
env = Environment("empty")
"""


class Journey:
    """The steps of the tutorial that the pictures need."""

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
        # the tutorial uses the default port; another simulation may use it here
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


def view(journey: Journey) -> None:
    """The live view with its panels and a plot of a measurement."""
    with journey.running() as (running, simulation), Studio() as studio:
        studio.watch(running.url)
        page = studio.page
        page.get_by_role("treeitem", name="pose").click()
        page.locator(".inspector tr.numeric").first.wait_for()
        # one plot: a second one beside it does not fit next to the log
        page.locator(".inspector .data th").get_by_text("x", exact=True).press("Enter")
        page.evaluate("document.activeElement.blur()")
        for keys, seconds in ((["ArrowUp"], 1.0), (["ArrowUp", "ArrowLeft"], 3.0), (["ArrowUp"], 0.5)):
            for key in keys:
                page.keyboard.down(key)
            simulation.sleep(seconds)
            for key in keys:
                page.keyboard.up(key)
        pose = simulation.robot.pose.get()
        studio.look((pose["x"] - 3.2, pose["y"] - 4.0, 2.8), (pose["x"] + 0.4, pose["y"], 0.7))
        save("view", [studio.still(simulation)])


def ranger(journey: Journey) -> None:
    """Your own robot: before it has an actuator for the eyes."""
    journey.own_robot()
    with journey.running() as (running, simulation), Studio() as studio:
        studio.watch(running.url)
        studio.hide_tree()
        studio.look((4.6, -2.6, 2.0), (1.0, 0.15, 0.5))
        save("ranger", [studio.still(simulation)])


def controller(journey: Journey) -> None:
    """A program drives the ranger."""
    journey.own_robot()
    with journey.running() as (running, simulation), Studio(860, 560) as studio:
        studio.watch(running.url)
        studio.hide_tree()
        studio.look((4.6, -2.2, 1.8), (1.6, 0.1, 0.45))
        terminal = journey.client("keyboard_first.py", simulation.port)
        said = "$ python3 ranger_sim/scripts/keyboard_ctrl.py\n"
        for key in "wwwwaa":
            terminal.expect_exact("WASD?")
            said += f"{terminal.before.strip()}\nWASD?".lstrip("\n")
            terminal.sendline(key)
        wait_for(lambda: simulation.robot.pose.get()["x"] > START[0] + 0.8, "the ranger to drive")
        picture = studio.still(simulation)
        terminal.expect_exact("WASD?")
        said += f"{terminal.before.strip()}\nWASD?"
        terminal.close()
        save("controller", [beside(picture, studio.terminal(said, 460, picture.height))])


def eyes(journey: Journey) -> None:
    """The eyes move: a film."""
    journey.own_robot()
    journey.own_actuator()
    frames = []
    with journey.running() as (running, simulation), Studio(900, 560) as studio:
        studio.watch(running.url)
        studio.hide_tree()
        studio.look((4.2, -0.9, 1.4), (1.5, 0.0, 0.62))
        simulation.rpc("simulation", "pause")
        for turn in (0.0, 0.5, 1.0, 1.5, 1.0, 0.5, 0.0, -0.5, -1.0, -1.5, -1.0, -0.5):
            simulation.robot.eyes.publish({"left": turn, "right": turn})
            time.sleep(0.2)
            simulation.rpc("simulation", "step", 3)
            frames.append(studio.shot().crop((130, 150, 770, 550)))
    save("eyes", frames, 160)


def _furnished(journey: Journey) -> Path:
    """Chapters five and six: the script of the scene."""
    journey.own_robot()
    journey.own_actuator()
    journey.person.edits("draw_playroom.py", None, str(journey.project / "data/ranger_sim/environments/playroom.blend"))
    scene = journey.project / "default.py"
    scene.write_text(block("playroom.py"))
    return scene


def playroom(journey: Journey) -> None:
    """Your own world."""
    with morse.load(_furnished(journey)) as simulation:
        simulation.step(60)
        save("playroom", [Image.fromarray(simulation.picture(1280, 800))])


def moods(journey: Journey) -> None:
    """An LED array shows a smile."""
    scene = _furnished(journey)
    journey.person.types("add", "actuator", "mood", "ranger_sim", answer="Shows the mood of the ranger\n")
    source = journey.project / "src/ranger_sim"
    (source / "actuators/mood.py").write_text(block("mood.py"))
    (source / "builder/actuators/mood.py").write_text(block("mood_builder.py"))
    builder = source / "builder/robots/ranger.py"
    at = "        self.append(self.motion)\n"
    added = at + "".join(f"        {line}\n" for line in block("mood_lines.py").splitlines())
    text = builder.read_text().replace(block("builder_import.py"), block("mood_import.py"))
    builder.write_text(text.replace(at, added))
    with morse.load(scene) as simulation:
        simulation.step(60)
        simulation.robot.mood.show("happy")
        simulation.step(2)
        view = {"location": (-0.6, -1.1, 1.0), "rotation": (1.38, 0.0, 1.05), "focal_length": 32.0}
        save("moods", [Image.fromarray(simulation.picture(1280, 800, **view))])


#: name of a class to its position (x, y, z) and heading
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
        studio.hide_tree()
        studio.look((8.6, -0.3, 2.9), (0.0, -0.15, 0.75))
        save("robots", [studio.still(simulation)])


#: pictures of the gallery of the live view that the documentation shows
_GALLERY = ("indoors", "outdoors", "office", "warehouse")


def gallery(journey: Journey) -> None:
    """Other worlds."""
    folder = journey.person.folder / "gallery"
    take = Path(__file__).parents[2] / "tools" / "gallery" / "take.py"
    subprocess.run([sys.executable, str(take), str(folder), *_GALLERY], check=True)
    for name in _GALLERY:
        with Image.open(folder / f"{name}.png") as picture:
            save(name, [picture.convert("RGB").resize((1280, 800), Image.Resampling.LANCZOS)])


def thermal(journey: Journey) -> None:
    """Temperatures of a scene."""
    heat.thermal(journey.person.folder)


def tour(journey: Journey) -> None:
    """What the live view shows: a film of a recorded run."""
    page_file = journey.person.folder / "run.html"
    write_page("tour", page_file)
    frames = []
    with Studio(880, 540) as studio:
        studio.watch(page_file.as_uri(), quality="low")  # smaller than a still
        studio.page.evaluate("morse.connection.send({ type: 'pause' })")
        for number in range(20):
            studio.page.evaluate(f"morse.connection.send({{ type: 'rewind', time: {1.0 + 0.6 * number} }})")
            frames.append(studio.shot().resize((720, 442), Image.Resampling.LANCZOS))
    save("tour", frames, 250, limit=900_000)


PICTURES = {
    made.__name__: made
    for made in (tour, morsy, keys, view, ranger, controller, eyes, playroom, moods, robots, gallery, thermal)
}


def main(names: list[str]) -> None:
    """Make the pictures of these names, or all."""
    for name in names or PICTURES:
        with tempfile.TemporaryDirectory() as folder:
            PICTURES[name](Journey(Path(folder)))
        print(f"made {name}")


if __name__ == "__main__":
    main(sys.argv[1:])
