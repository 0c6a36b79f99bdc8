"""The pictures on the pages of components; ``tools/gallery/components.py`` takes them by running the examples."""

from __future__ import annotations

from pathlib import Path

FOLDER = Path(__file__).parents[1] / "pictures" / "library"
#: ending of a file to what it shows
_KINDS = {
    ".webp": "The example on this page, from before",
    "-image.webp": "What it sees",
    "-points.webp": "What it measures, seen from above: 20 m wide, ahead is up",
    ".svg": "What it says over time, while the robot drives a bend",
}


def of(name: str) -> str:
    """The pictures of a component that there are."""
    found = [(f"{name.lower()}{ending}", what) for ending, what in _KINDS.items()]
    return "\n\n".join(
        f"![{name}: {what[0].lower()}{what[1:]}](../../pictures/library/{file})\n\n*{what}.*"
        for file, what in found
        if (FOLDER / file).is_file()
    )
