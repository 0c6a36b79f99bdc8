"""Pictures that clients and programs name."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING

from morse.assets.meshfiles.pictures import Pictures
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.reports.quoting import quoted
from morse.scene import shared_image
from morse.services.foreign_models import check_model
from morse.system.pictures import open_picture
from morse.system.regular_files import read_regular

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Sequence

    from morse.scene import Image

#: size of a file, bytes
_LARGEST = 1 << 26
#: number of pictures that are kept
_MOST = 100


class NamedPictures:
    """Pictures in the folders of models, and in the folder in which the simulation was started.

    Args:
        folders: returns the folders with models.
    """

    def __init__(self, folders: Callable[[], Sequence[str | os.PathLike[str]]]) -> None:
        self._folders = folders
        #: by path, time and size of the file
        self._images: dict[tuple[Path, int, int], Image] = {}

    def image(self, name: str) -> Image:
        """Read a PNG or JPEG file, given its path, or its path in one of the folders.

        Raises:
            MorseRPCInvokationError: it is not there, in another folder, or no picture.
        """
        folders = [Path(folder) for folder in self._folders()]
        check_model(name, folders)
        with contextlib.suppress(OSError):  # the present folder was deleted
            folders.append(Path.cwd())
        path = next((folder / name for folder in folders if (folder / name).is_file()), None)
        if path is None:
            places = ", ".join(map(str, folders))
            raise MorseRPCInvokationError(f"there is no picture {quoted(name)} in {places}")
        reader = Pictures()
        try:
            facts = path.stat()
            version = path, facts.st_mtime_ns, facts.st_size
            if version in self._images:
                return self._images[version]
            if facts.st_size > _LARGEST:
                raise OSError(f"it has more than {_LARGEST >> 20} MB")
            with open_picture(read_regular(path, _LARGEST)) as picture:
                image = reader.image(path.name, picture)
        except (OSError, ValueError) as error:
            raise MorseRPCInvokationError(f"the picture {path} cannot be read: {error!s:.200}") from None
        if reader.warnings:
            raise MorseRPCInvokationError(f"the picture {path} cannot be used: {reader.warnings[0]}")
        if len(self._images) >= _MOST:
            self._images.clear()
        image_file = self._images[version] = shared_image(image.name, image.data, image.mime)
        return image_file
