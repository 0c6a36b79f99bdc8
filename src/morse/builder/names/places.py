"""The folders of a project around a scene script, whether the project is registered or not."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.formats import is_model
from morse.system.shared_folders import folders_above

if TYPE_CHECKING:
    from pathlib import Path

#: number of folders above a script that may contain the project
_LEVELS = 4


def source_folders(script: Path) -> list[str]:
    """Folders of Python packages: ``src`` beside the script or above it, nearest first; then that of the script.

    A model that is run as a scene is data: it brings no code.
    """
    if is_model(script):
        return []
    return [*_named("src", script), str(script.parent)]


def resource_folders(script: Path) -> list[str]:
    """Folders of models: ``data`` beside the script or above it, nearest first; then that of the script."""
    return [*_named("data", script), str(script.parent)]


def _named(name: str, script: Path) -> list[str]:
    folders = [folder / name for folder in folders_above(script)[:_LEVELS]]
    return [str(folder) for folder in folders if folder.is_dir()]
