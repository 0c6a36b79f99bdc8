"""The photos of a vehicle, in memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from morse.mathutils.rotations import Quaternion4

#: bytes of all photos, of which the oldest are dropped; number of photos whose place is remembered
_MOST_BYTES, _MOST_PHOTOS = 1 << 26, 10_000


class Photo(NamedTuple):
    """One photo.

    Attributes:
        number: counts the photos of the camera from 0.
        path: of its file.
        stamp: simulated time, ns.
        place: latitude and longitude, 1e-7 degrees, altitude and height above home, mm.
        orientation: of the camera, w, x, y, z; forward, right, down to north, east, down.
    """

    number: int
    path: str
    stamp: int
    place: tuple[int, ...]
    orientation: Quaternion4

    @property
    def url(self) -> str:
        """Where MAVLink FTP has it."""
        return f"mftp:///{self.path}"


class Photos(Mapping[str, bytes]):
    """The files by path, and the list of what each camera has taken.

    Attributes:
        capacity: bytes.
        used: bytes.
    """

    capacity = _MOST_BYTES

    def __init__(self) -> None:
        self.used = 0
        self._files: dict[str, bytes] = {}
        self._lists: dict[int, list[Photo]] = {}

    def __getitem__(self, path: str) -> bytes:
        return self._files[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self._files)

    def __len__(self) -> int:
        return len(self._files)

    def add(
        self, component: int, content: bytes, stamp: int, place: tuple[int, ...], orientation: Quaternion4
    ) -> Photo:
        """Store a photo of the camera with an id; see `Photo`."""
        photos = self._lists.setdefault(component, [])
        number = photos[-1].number + 1 if photos else 0
        photo = Photo(number, f"DCIM/{component}/{number:06d}.jpg", stamp, place, orientation)
        photos.append(photo)
        del photos[:-_MOST_PHOTOS]
        self._files[photo.path] = content
        self.used += len(content)
        while self.used > _MOST_BYTES:
            self.used -= len(self._files.pop(next(iter(self._files))))
        return photo

    def photo(self, component: int, number: float) -> Photo | None:
        """A photo of a camera; None if it is not remembered."""
        photos = self._lists.get(component)
        if not photos or not photos[0].number <= number <= photos[-1].number:
            return None
        return photos[int(number) - photos[0].number]

    def count(self, component: int) -> int:
        """How many photos a camera has taken."""
        photos = self._lists.get(component)
        return photos[-1].number + 1 if photos else 0

    def has(self, photo: Photo) -> bool:
        """Whether the file of a photo is still there."""
        return photo.path in self._files

    def clear(self) -> None:
        """Delete all photos."""
        self._files.clear()
        self._lists.clear()
        self.used = 0
