"""Textures: packed into the file, or beside it."""

from __future__ import annotations

import stat
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.blend.errors import Damage
from morse.assets.blend.record import datablock_name
from morse.scene import Image

if TYPE_CHECKING:
    from morse.assets.blend.record import Record

#: bytes of one encoded picture
_MAX_BYTES = 256 << 20
#: bytes of all pictures of a file
_MAX_TOTAL = 1 << 30
#: names in one warning
_MAX_NAMED = 5
_GENERATED, _VIEWER = 4, 5
_SIGNATURES = {b"\x89PNG\r\n\x1a\n": "image/png", b"\xff\xd8\xff": "image/jpeg"}


class Images:
    """Reads each image once, however many materials show it."""

    def __init__(self, path: Path) -> None:
        self._folder = path.parent
        self._read: dict[int, Image | None] = {}
        self._foreign: list[str] = []
        self._total = 0
        #: the images read so far, by name
        self.by_name: dict[str, Image] = {}

    def image(self, record: Record) -> Image | None:
        """The picture of an image datablock, or None (with a warning) if there is no PNG or JPEG."""
        if record.offset not in self._read:
            image = self._read[record.offset] = self._image(record)
            if image is not None:
                self.by_name.setdefault(image.name, image)
        return self._read[record.offset]

    def warnings(self) -> list[str]:
        """One sentence about all images in formats that nothing here can show."""
        if not self._foreign:
            return []
        names = ", ".join(f"'{name}'" for name in self._foreign[:_MAX_NAMED])
        more = f" and {len(self._foreign) - _MAX_NAMED} more" if len(self._foreign) > _MAX_NAMED else ""
        return [f"images that are neither PNG nor JPEG are left out (save them as such): {names}{more}"]

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
        except Damage as damage:
            record.file.warn(f"the image '{name}' is left out: {damage}")
            return None
        mime = next((mime for signature, mime in _SIGNATURES.items() if data.startswith(signature)), None)
        if mime is None:
            self._foreign.append(name)
            return None
        return Image(name, data, mime)

    def _external(self, record: Record) -> bytes:
        stored = record.text(record.either("name", "filepath"))
        path = _resolve(stored, self._folder)
        if path is None:
            raise Damage(f"its path '{stored}' cannot be followed; store it relative to the .blend file")
        try:
            status = path.stat()
            if not stat.S_ISREG(status.st_mode):
                raise Damage(f"'{path}' is not a file")
            if status.st_size > _MAX_BYTES:
                raise Damage(f"'{path}' is larger than {_MAX_BYTES >> 20} MiB")
            with path.open("rb") as file:
                # a look at the first bytes: nothing but pictures is read
                head = file.read(16)
                if not any(head.startswith(signature) for signature in _SIGNATURES):
                    return head
                return head + file.read(_MAX_BYTES)
        except (OSError, ValueError) as error:
            raise Damage(f"its file '{path}' cannot be read; put it there or pack it into the .blend file") from error


def _is_packed(record: Record) -> bool:
    if record.has("packedfiles") and record.part("packedfiles").integer("first"):
        return True
    return bool(record.integer("packedfile", 0))


def _packed(record: Record) -> bytes:
    packed = record.follow("packedfile", "PackedFile") if record.integer("packedfile", 0) else None
    if packed is None:
        entry = next(record.chain("packedfiles", "ImagePackedFile"), None)
        packed = None if entry is None else entry.follow("packedfile", "PackedFile")
    if packed is None:
        raise Damage("its packed bytes are missing")
    block, size = packed.target("data"), packed.integer("size")
    if block is None or not 0 < size <= block.size:
        raise Damage("its packed bytes are cut off")
    if size > _MAX_BYTES:
        raise Damage(f"it is larger than {_MAX_BYTES >> 20} MiB")
    return packed.file.data[block.offset : block.offset + size]


def _resolve(stored: str, folder: Path) -> Path | None:
    """The file that a path in Blender's notation means (``//`` is the folder of the .blend file)."""
    if stored.startswith("//"):
        path = folder / stored[2:].replace("\\", "/")
    elif stored.startswith("\\\\") or not stored:
        # a share of another computer: opening it would send the user's credentials there
        return None
    else:
        path = Path(stored.replace("\\", "/"))
        if not path.is_absolute():
            path = folder / path
    return path
