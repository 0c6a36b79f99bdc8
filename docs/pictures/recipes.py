"""Create the pictures of the recipes: ``python docs/pictures/recipes.py [NAME ...]``.

A recipe that writes an image is shown by it, any other one by its world, with paths, rays, images and curves.
"""

from __future__ import annotations

import contextlib
import re
import runpy
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from PIL import Image, ImageOps
from recipe_drawing import Track, chart, cloud, picture

import morse
from morse.simulation.simulation import Simulation

if TYPE_CHECKING:
    from collections.abc import Iterator

PAGE = Path(__file__).parents[1] / "recipes.md"
FOLDER = Path(__file__).with_name("recipes")
SIZE = (640, 400)
#: calls of the function that a test gets as its fixture, for the picture of a recipe that is a test
_AS_TEST = """
loaded = []
test_it_drives(lambda scene, **_: loaded.append(morse.load(scene)) or loaded[0], 1.0)
loaded[0].close()
"""


def recipes() -> dict[str, str]:
    """Name of a picture to the text of its recipe."""
    parts = re.findall(r"```python\n(.*?)```.*?pictures/recipes/([\w-]+)\.webp", PAGE.read_text("utf-8"), re.DOTALL)
    return {name: text for text, name in parts}


@contextlib.contextmanager
def watched() -> Iterator[list[Image.Image]]:
    """Within the block, each simulation that is closed leaves a picture."""
    pictures: list[Image.Image] = []
    start, close = Simulation.__init__, Simulation.close
    tracks: dict[int, Track] = {}

    def begin(self: Any, *arguments: Any, **options: Any) -> None:
        start(self, *arguments, **options)
        tracks[id(self)] = Track(self)
        self.observers.append(tracks[id(self)])

    def end(self: Any) -> None:
        own = tracks.get(id(self))
        if own is not None and not own.shown:
            own.shown = True
            pictures.append(picture(self, [own, *(track for track in tracks.values() if track is not own)], SIZE))
        close(self)

    Simulation.__init__, Simulation.close = begin, end  # type: ignore[method-assign]
    try:
        yield pictures
    finally:
        Simulation.__init__, Simulation.close = start, close  # type: ignore[method-assign]


def shown(text: str, folder: Path) -> Image.Image:
    """The picture of a recipe, which is run in a folder."""
    script = folder / "recipe.py"
    script.write_text(text, encoding="utf-8")
    with contextlib.chdir(folder), watched() as pictures:
        if "def test_" in text:
            script.write_text("import morse\n" + text + _AS_TEST, encoding="utf-8")
        if "import morse\n" in script.read_text("utf-8") or "from morse.many" in text or "from morse.gym" in text:
            names = runpy.run_path(str(script), run_name="__main__")
            if "table" in names and hasattr(names["table"], "to_dict"):
                return chart(names["table"].to_dict(), SIZE)
        else:
            with morse.load(script) as simulation:
                drive = simulation.context.component("robot.motion")
                if drive is not None:
                    simulation.robot.motion.publish({"v": 1.0, "w": 0.5})
                simulation.step(180)
    if (folder / "cloud.ply").exists():
        return cloud(np.loadtxt(folder / "cloud.ply", skiprows=7), SIZE)
    images = [file for file in sorted(folder.iterdir()) if file.suffix in (".png", ".gif")]
    return Image.open(images[0]).convert("RGB") if images else pictures[-1]


def main() -> None:
    """Make the pictures with these names, or all."""
    FOLDER.mkdir(exist_ok=True)
    names = sys.argv[1:]
    for name, text in recipes().items():
        if names and name not in names:
            continue
        with tempfile.TemporaryDirectory() as folder:
            image = shown(text, Path(folder))
        image = ImageOps.contain(image, (SIZE[0], SIZE[0]))
        image.save(FOLDER / f"{name}.webp", quality=72, method=6)
        print(name)


if __name__ == "__main__":
    main()
