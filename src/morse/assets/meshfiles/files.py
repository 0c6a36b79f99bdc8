"""Access to the files that a model file refers to: only those in its folder and below."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

#: maximum size of a file, bytes
SIZE_LIMIT = 512 << 20


class Below:
    """Gives trimesh the files that a model refers to; an untrusted model must not read other files.

    Attributes:
        refused: names of files that are outside of the folder, are missing or are too large.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = Path(os.path.realpath(folder))
        self.refused: list[str] = []

    def get(self, name: str) -> bytes:
        """The content of a file.

        Raises:
            FileNotFoundError: it is outside of the folder, is missing or is too large.
        """
        try:
            path = Path(os.path.realpath(self._folder / str(name).strip().replace("\\", "/")))
            if path.is_relative_to(self._folder) and path.is_file() and path.stat().st_size <= SIZE_LIMIT:
                return path.read_bytes()
        except (OSError, ValueError):
            pass
        self.refused.append(str(name))
        raise FileNotFoundError(f"'{name!s:.200}' cannot be read from the folder of the model")

    def __getitem__(self, name: str) -> bytes:
        return self.get(name)

    def __contains__(self, name: object) -> bool:
        return (self._folder / str(name)).is_file()

    def keys(self) -> Iterator[str]:
        """Return no names: a folder may be large, and trimesh requests files by name."""
        return iter(())

    def write(self, name: str, data: bytes) -> None:
        """Refuse: models are read only."""
        raise PermissionError(name)

    def namespaced(self, namespace: str) -> Below:
        """Access to the files of a subfolder."""
        return Below(self._folder / namespace)
