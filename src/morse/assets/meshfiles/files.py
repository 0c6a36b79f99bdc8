"""Access to the files that a model file refers to: only those in its folder and below."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.meshfiles.pictures import is_picture, mistake_in
from morse.assets.stand_in import chequered

if TYPE_CHECKING:
    from collections.abc import Iterator

#: maximum size of a file, bytes
SIZE_LIMIT = 512 << 20


class Below:
    """Gives trimesh the files that a model refers to; an untrusted model must not read other files.

    Attributes:
        refused: names of files that are outside of the folder, are missing or are too large.
        unusable: names of pictures that cannot be used, with the reason; a chequered pattern is used instead.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = Path(os.path.realpath(folder))
        self.refused: list[str] = []
        self.unusable: dict[str, str] = {}

    def get(self, name: str) -> bytes:
        """The content of a file; a chequered pattern for a picture that cannot be used.

        Raises:
            FileNotFoundError: it is no picture, and is outside of the folder, is missing or is too large.
        """
        try:
            path = Path(os.path.realpath(self._folder / str(name).strip().replace("\\", "/")))
            if path.is_relative_to(self._folder) and path.is_file() and path.stat().st_size <= SIZE_LIMIT:
                return self._checked(str(name), path.read_bytes())
        except (OSError, ValueError):
            pass
        if is_picture(str(name)):
            self.unusable[str(name)] = "it is missing, or outside of the folder of the model"
            return chequered()
        self.refused.append(str(name))
        raise FileNotFoundError(f"'{name!s:.200}' cannot be read from the folder of the model")

    def _checked(self, name: str, data: bytes) -> bytes:
        if is_picture(name) and (mistake := mistake_in(data)):
            self.unusable[name] = mistake
            return chequered()
        return data

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
