"""The pictures on the pages of components; ``python -m tools`` creates them by running the examples."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parents[1] / "pictures" / "library"
#: suffix of a file to its caption
_KINDS = {
    ".webp": "The example on this page, seen from the front",
    "-image.webp": "Its image",
    "-points.webp": "Its measurements from above: 20 m wide, ahead is up",
    ".svg": "Its data over time, while the robot drives along a bend",
}


WORLDS = FOLDER.parent / "worlds"


def of_world(name: str) -> str:
    """The picture of a world; ``python docs/pictures/worlds.py`` creates them all."""
    file = f"{name.replace('/', '-')}.webp"
    return f"![The world {name}](../pictures/worlds/{file})\n" if (WORLDS / file).is_file() else ""


def thumbnail(name: str, folders: str) -> str:
    """A small picture of a component, for a table; empty if there is none."""
    file = f"{name.lower()}.webp"
    return f"![{name}]({folders}pictures/library/{file}){{width=130px}}" if (FOLDER / file).is_file() else ""


def of(name: str) -> str:
    """The existing pictures of a component."""
    found = [(f"{name.lower()}{ending}", what) for ending, what in _KINDS.items()]
    return "\n\n".join(
        f"![{name}: {what[0].lower()}{what[1:]}](../../pictures/library/{file})\n\n*{what}.*"
        for file, what in found
        if (FOLDER / file).is_file()
    )
