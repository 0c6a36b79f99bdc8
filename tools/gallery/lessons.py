"""Creates the films of the lessons: ``python tools/gallery/lessons.py [NAME...]``, in ``docs/pictures/lessons``.

Each film shows the robot with the solution of the tests, eight times as fast as it was.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path

from PIL import Image

from morse.cli.app import execute
from morse.plugins.lessons.attempt import Attempt
from morse.plugins.lessons.catalog import lesson, lessons

ROOT = Path(__file__).parents[2]
FILMS = ROOT / "docs" / "pictures" / "lessons"
SOLUTIONS = ROOT / "tests" / "plugins" / "lessons" / "solutions"
#: the viewpoint, and what it looks at, m
VIEWS = {
    "line": ("0,-8,8", "0,0,0"),
    "wall": ("0,-9,10", "0,-0.5,0"),
    "pid": ("0,-6,2", "0,0,1.4"),
    "odometry": ("2,-9,8", "2,0.5,0"),
    "dock": ("1.5,-6,4", "2,0,0"),
    "tuning": ("3,-6,4", "3,0,0"),
    "testing": ("3,-6,4", "3,0,0"),
    "traffic": ("7,-9,9", "-0.5,-1,0"),
    "mapping": ("0,-9,10", "0,-0.5,0"),
    "planning": ("8,-7,14", "8,5,0"),
    "gates": ("4,-8,8", "4,4,1.5"),
    "search": ("0,-11,13", "0,-0.5,0"),
}
#: frames per simulated second, and milliseconds of each
RATE, SHOWN = 2.0, 62


def film(name: str) -> None:
    """Run the solution, and film it."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        shutil.copy(SOLUTIONS / f"{name}.py", folder / "controller.py")
        attempt = Attempt(lesson(name), folder, record=folder / "run.mcap")
        attempt.run(lambda: None)
        assert all(finding.is_right for finding in attempt.findings), attempt.findings
        view, at = VIEWS[name]
        rate = 10.0 if name == "pid" else RATE
        words = ["--film", "--from", view, "--at", at, "--size", "400x250", "--rate", f"{rate}", "--fine"]
        assert execute(["export", str(folder / "run.mcap"), *words, "-o", str(folder / "frame_%04d.png")]) == 0
        # the first minute of many drives is enough
        frames = [Image.open(path).convert("RGB") for path in sorted(folder.glob("frame_*.png"))[:120]]
    FILMS.mkdir(exist_ok=True)
    frames[0].save(
        FILMS / f"{name}.webp", save_all=True, append_images=frames[1:], duration=SHOWN, loop=0, quality=60, method=6
    )


if __name__ == "__main__":
    for chosen in sys.argv[1:] or lessons()[0]:
        film(chosen)
