"""Textures, packed into the file or in separate files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.pictures import HEADER_SIZE, TargaError, is_targa, png_of
from morse.assets.search import component_dirs, resource_dirs
from morse.plugins.blend.container import Damage
from morse.plugins.blend.file import datablock_name
from morse.scene import Image
from morse.system.regular_files import open_regular
from morse.system.variables import paths

if TYPE_CHECKING:
    from morse.plugins.blend.file import Record

#: environment variable with further directories from which models may read images
PATH_VARIABLE = "MORSE_IMAGE_PATH"
#: maximum size of one encoded image, bytes
_MAX_BYTES = 256 << 20
#: maximum size of all images of a file, bytes
_MAX_TOTAL = 1 << 30
#: maximum number of names in a warning
_MAX_NAMED = 5
#: signatures of image formats
_SIGNATURE = 8
_GENERATED, _VIEWER = 4, 5
_SIGNATURES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}
_TIFF = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")


class Images:
    """Reads each image once, for all materials that use it."""

    def __init__(self, path: Path) -> None:
        self._folder = path.parent
        self._read: dict[int, Image | None] = {}
        self._foreign: list[str] = []
        self._tiff: list[str] = []
        self._total = 0
        #: the images read so far, by name
        self.by_name: dict[str, Image] = {}

    def image(self, record: Record) -> Image | None:
        """Return the image of an image datablock, or None (with a warning) if it is not PNG, JPEG or TGA."""
        if record.offset not in self._read:
            image = self._read[record.offset] = self._image(record)
            if image is not None:
                self.by_name.setdefault(image.name, image)
        return self._read[record.offset]

    def warnings(self) -> list[str]:
        """Return one warning about all TIFF images, and one about images in other formats that are not read."""
        sentences = []
        if self._tiff:
            sentences.append(f"TIFF images are not read (save them as PNG): {_listed(self._tiff)}")
        if self._foreign:
            names = _listed(self._foreign)
            sentences.append(f"images that are neither PNG, JPEG nor TGA are left out (save them as PNG): {names}")
        return sentences

    def _image(self, record: Record) -> Image | None:
        name = datablock_name(record)
        if record.integer("source", 1) in (_GENERATED, _VIEWER) and not _is_packed(record):
            record.file.warn(f"the image '{name}' is painted by Blender itself; pack it into the file to see it here")
            return None
        try:
            if self._total > _MAX_TOTAL:
                raise Damage(f"all images together are larger than {_MAX_TOTAL >> 20} MiB")
            data = _packed(record) if _is_packed(record) else self._external(record)
            self._total += len(data)
            mime = next((mime for signature, mime in _SIGNATURES.items() if data.startswith(signature)), None)
            if mime is None and is_targa(data):
                data, mime = _converted(data), "image/png"
                self._total += len(data)
        except Damage as damage:
            record.file.warn(f"the image '{name}' is left out: {damage}")
            return None
        if mime is None:
            (self._tiff if data.startswith(_TIFF) else self._foreign).append(name)
            return None
        return Image(name, data, mime)

    def _external(self, record: Record) -> bytes:
        address = record.text(record.either("name", "filepath"))
        path = _resolve(address, self._folder)
        if path is None:
            raise Damage(f"its path '{address}' cannot be resolved; store it relative to the .blend file")
        if not _is_allowed(path, self._folder):
            raise Damage(
                f"its path '{address}' is outside of the folder of the model; put the image below it, pack it into the "
                f".blend file, or list the image's folder in the environment variable {PATH_VARIABLE}"
            )
        try:
            with open_regular(path, _MAX_BYTES) as file:
                # checks the first bytes, so that only images are read
                head = file.read(HEADER_SIZE)
                is_picture = any(head.startswith(signature) for signature in _SIGNATURES)
                # TGA has no signature, so the suffix is checked as well
                if not is_picture and not (path.suffix.lower() == ".tga" and is_targa(head)):
                    return head[:_SIGNATURE]
                return head + file.read(_MAX_BYTES)
        except (OSError, ValueError) as error:
            if isinstance(error, OSError) and os.path.exists(path):
                raise Damage(f"'{path}' is not a file that can be read: {error.strerror}") from error
            raise Damage(f"its file '{path}' cannot be read; put it there or pack it into the .blend file") from error


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - _MAX_NAMED} more" if len(names) > _MAX_NAMED else ""
    return ", ".join(f"'{name}'" for name in names[:_MAX_NAMED]) + more


def _converted(data: bytes) -> bytes:
    try:
        return png_of(data)
    except TargaError as error:
        raise Damage(str(error)) from error


def _is_allowed(path: Path, folder: Path) -> bool:
    """Whether a model may read an image; an untrusted model must not read other files of the user."""
    folders = [folder, *resource_dirs(), *component_dirs(), *map(Path, paths(PATH_VARIABLE))]
    try:
        # symbolic links are resolved, because a link inside the directory may point out of it
        real = Path(os.path.realpath(path))
        return any(real.is_relative_to(os.path.realpath(directory)) for directory in folders)
    except (OSError, ValueError):
        return False


def _is_packed(record: Record) -> bool:
    if record.has("packedfiles") and record.part("packedfiles").integer("first"):
        return True
    return bool(record.integer("packedfile", 0))


def _packed(record: Record) -> bytes:
    packed_file = record.follow("packedfile", "PackedFile") if record.integer("packedfile", 0) else None
    if packed_file is None:
        entry = next(record.chain("packedfiles", "ImagePackedFile"), None)
        packed_file = None if entry is None else entry.follow("packedfile", "PackedFile")
    if packed_file is None:
        raise Damage("its packed bytes are missing")
    block, size = packed_file.target("data"), packed_file.integer("size")
    if block is None or not 0 < size <= block.size:
        raise Damage("its packed bytes are cut off")
    if size > _MAX_BYTES:
        raise Damage(f"it is larger than {_MAX_BYTES >> 20} MiB")
    return packed_file.file.data[block.offset : block.offset + size]


def _resolve(address: str, folder: Path) -> Path | None:
    """Resolve a path in Blender's notation (``//`` is the directory of the .blend file)."""
    if address.startswith("//"):
        path = folder / address[2:].replace("\\", "/")
    elif address.startswith("\\\\") or not address:
        # this is a network share: opening it would send the credentials of the user to another computer
        return None
    else:
        path = Path(address.replace("\\", "/"))
        if not path.is_absolute():
            path = folder / path
    return path
