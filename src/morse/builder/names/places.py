"""The folders of a project around a scene script, whether the project is registered or not."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

#: number of folders above a script that may contain the project
_LEVELS = 4


def _around(script: Path) -> Iterator[Path]:
    """The folder of a script and those above it, without folders that contain many projects."""
    shared_folders = {Path.home(), Path(tempfile.gettempdir()), Path(script.anchor)}
    for folder in list(script.absolute().parents)[:_LEVELS]:
        if folder in shared_folders:
            return
        yield folder


def source_folders(script: Path) -> list[str]:
    """Folders of Python packages: ``src`` beside the script or above it, nearest first; then that of the script."""
    return [str(folder / "src") for folder in _around(script) if (folder / "src").is_dir()] + [str(script.parent)]


def resource_folders(script: Path) -> list[str]:
    """Folders of models: ``data`` beside the script or above it, nearest first; then that of the script."""
    return [str(folder / "data") for folder in _around(script) if (folder / "data").is_dir()] + [str(script.parent)]
