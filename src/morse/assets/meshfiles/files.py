"""Access to the files that a model file refers to: only those in its folder and below, or in its model of Gazebo."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.pictures import chequered, is_picture, usable_picture
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterator

#: maximum size of a model, and of all files together that it refers to, bytes
SIZE_LIMIT = 512 << 20
#: folders of a model of Gazebo with pictures, and levels between it and its meshes
_TEXTURES, _LEVELS = ("materials/textures", "meshes", "."), 3
#: files of text whose encoding is not defined
_TEXTS = (".mtl", ".obj")


class Below:
    """Gives trimesh the files that a model refers to; an untrusted model must not read other files.

    Attributes:
        refused: names of files that are outside of the folder, are missing or are too large.
        pictures: by number, what replaces a picture within the file.
        unusable: names of pictures that cannot be used, with the reason; a chequered pattern is used instead.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = Path(os.path.realpath(folder))
        self._model = _model_of(self._folder)
        self.refused: list[str] = []
        self.unusable: dict[str, str] = {}
        self.pictures: dict[int, bytes] = {}
        self._files: dict[Path, bytes] = {}
        self._pictures: dict[Path, bytes | str] = {}
        self._bytes = 0

    def get(self, name: str) -> bytes:
        """The content of a file; a chequered pattern for a picture that cannot be used.

        Raises:
            FileNotFoundError: it is not a picture, and is outside of the folder, is missing or is too large, together
                with the files before.
        """
        try:
            for candidate in self._candidates(str(name).strip().replace("\\", "/")):
                path = Path(os.path.realpath(candidate))
                if path.is_relative_to(self._model or self._folder) and path.is_file():
                    return self._checked(str(name), path, self._content(path))
        except (OSError, ValueError):
            pass
        if is_picture(str(name)):
            self.unusable[str(name)] = "it is missing, or outside of the folder of the model"
            return chequered()
        self.refused.append(str(name))
        raise FileNotFoundError(f"'{name!s:.200}' cannot be read from the folder of the model")

    def _candidates(self, name: str) -> Iterator[Path]:
        yield self._folder / name
        if self._model is not None and is_picture(name):
            # the pictures of a model of Gazebo are found by their names alone
            for folder in _TEXTURES:
                yield self._model / folder / name.rsplit("/", 1)[-1]

    def _content(self, path: Path) -> bytes:
        """The content of a file, which is read once."""
        if path not in self._files:
            self._files[path] = readable(path, read_regular(path, SIZE_LIMIT - self._bytes))
            self._bytes += len(self._files[path])
        return self._files[path]

    def _checked(self, name: str, path: Path, data: bytes) -> bytes:
        if not is_picture(name):
            return data
        if path not in self._pictures:
            try:
                self._pictures[path] = usable_picture(data)
            except ValueError as mistake:
                self._pictures[path] = f"{mistake!s:.100}"
        picture = self._pictures[path]
        if isinstance(picture, str):
            self.unusable[name] = picture
            return chequered()
        return picture

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


def _model_of(folder: Path) -> Path | None:
    """The folder with ``model.config``, the one of a mesh or one above; None if it is not a model of Gazebo."""
    return next((one for one in (folder, *list(folder.parents)[:_LEVELS]) if (one / "model.config").is_file()), None)


def readable(path: Path, data: bytes) -> bytes:
    """The content of a model or a list of materials, in UTF-8 if it is text: other programs also write Latin-1."""
    if path.suffix.lower() not in _TEXTS:
        return data
    try:
        data.decode()
    except UnicodeDecodeError:
        return data.decode("latin-1").encode()
    return data
