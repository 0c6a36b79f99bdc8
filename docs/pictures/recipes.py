"""Create the pictures of the recipes, by the renderer of MORSE: ``python docs/pictures/recipes.py``."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

from PIL import Image

import morse

PAGE = Path(__file__).parents[1] / "recipes.md"
FOLDER = Path(__file__).with_name("recipes")
SIZE = (640, 400)


def recipes() -> dict[str, str]:
    """Name of a picture to the text of its scene."""
    parts = re.findall(r"```python\n(.*?)```.*?pictures/recipes/([\w-]+)\.webp", PAGE.read_text("utf-8"), re.DOTALL)
    return {name: text for text, name in parts}


def main() -> None:
    """Make all pictures."""
    FOLDER.mkdir(exist_ok=True)
    for name, text in recipes().items():
        with tempfile.TemporaryDirectory() as folder:
            script = Path(folder) / "scene.py"
            script.write_text(text, encoding="utf-8")
            with morse.load(script) as simulation:
                simulation.step(30)
                picture = Image.fromarray(simulation.picture(*SIZE))
        picture.save(FOLDER / f"{name}.webp", quality=72, method=6)
        print(name)


if __name__ == "__main__":
    main()
