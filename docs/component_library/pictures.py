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


def of(name: str) -> str:
    """The existing pictures of a component."""
    found = [(f"{name.lower()}{ending}", what) for ending, what in _KINDS.items()]
    return "\n\n".join(
        f"![{name}: {what[0].lower()}{what[1:]}](../../pictures/library/{file})\n\n*{what}.*"
        for file, what in found
        if (FOLDER / file).is_file()
    )
