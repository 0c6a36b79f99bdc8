"""Titles of pages."""

from __future__ import annotations

from pathlib import Path

#: names of scripts that say nothing: the name of the folder does
_COMMON = ("default", "scene", "main", "__main__")


def title_of(script: str, environment: str) -> str:
    """The name of the project of a scene script, or that of the script; without a script, that of the environment."""
    path = Path(script) if script else Path()
    name = path.absolute().parent.name if path.stem in _COMMON else path.stem
    return name or environment or "MORSE"
