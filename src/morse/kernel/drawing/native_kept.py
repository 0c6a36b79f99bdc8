"""The last image of a camera, for the C functions."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel.drawing.arrays import TILE
from morse.kernel.memory import address

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from morse.kernel.drawing.arrays import Light

#: shadow maps
_MAPS = 3
_ARRAYS = ("rgba", "depth", "ids", "normals", "models", "turns", "lamp_shadow", "reads")


class _Kept(ctypes.Structure):
    """``Kept`` of ``c/drawing.h``."""

    _fields_ = (
        *[(name, ctypes.c_void_p) for name in _ARRAYS],
        ("change", ctypes.c_int64),
        ("instances", ctypes.c_int32),
        ("is_complete", ctypes.c_int32),
    )


class Lit:
    """Everything that the colours of an image depend on, besides the poses and the camera.

    Attributes:
        key: the numbers.
        maps: the arrays that count the changes of the shadow maps.
    """

    def __init__(self, light: Light, samples: int) -> None:
        arrays = (light.lamps, light.sky, light.sun, light.near_sun, light.lamp_frame)
        self.key = (samples, *(None if array is None else array.tobytes() for array in arrays))
        self.maps = (light.shadow_changes, light.near_changes)
        self.lamp_shadow = light.lamp_shadow
        #: shadow maps whose changes are not counted may have changed
        self.is_known = (light.shadow is None) == (self.maps[0] is None)
        self.is_known &= (light.near_shadow is None) == (self.maps[1] is None)


class NativeKept:
    """The last image of a camera, of one drawer.

    An image is the same as the last one if all of these are: the camera, the lamps, the sky and the samples (`_key`),
    the poses of all instances, and the shadow maps. The kernel compares the poses and the maps tile by tile, the rest
    is compared here. All other data are those of the drawer.

    Images are only kept from the second one of a camera that stands: a camera that moves costs nothing.
    """

    def __init__(self, owner: object) -> None:
        self.owner = owner
        self._key: object = None
        self._maps: tuple[object, ...] = ()
        self._shape: tuple[int, int, bool, bool] | None = None
        self._arrays: dict[str, NDArray[np.generic] | None] = {}
        self._structure = _Kept()

    def begin(self, camera: NDArray[np.void], lit: Lit, instances: int) -> int | None:
        """Return the address of the structure for an image; None if the image is not kept.

        Args:
            camera: (1,) `CAMERA`.
        """
        row = camera.copy()
        row["tile"] = row["pixel"] = 0
        color = bool(row["color"][0])
        key = (row.tobytes(), lit.key if color else None)
        maps = lit.maps if color else ()
        same = key == self._key and all(one is other for one, other in zip(maps, self._maps, strict=True))
        if not same:
            self._key, self._maps = key, maps
            self._structure.is_complete = 0
            return None
        if color and not lit.is_known:
            return None
        self._make_room(camera[0], instances)
        return ctypes.addressof(self._structure)

    def end(self, lit: Lit) -> None:
        """The image is complete."""
        self._arrays["lamp_shadow"] = lit.lamp_shadow
        self._structure.lamp_shadow = address(lit.lamp_shadow)
        self._structure.is_complete = 1

    def _make_room(self, camera: np.void, instances: int) -> None:
        width, height = int(camera["width"]), int(camera["height"])
        tiles, pixels = -(-width // TILE) * -(-height // TILE), width * height
        shape = (width, height, bool(camera["color"]), bool(camera["normals"]))
        if self._shape == shape:
            return
        self._shape = shape
        self._arrays = {
            "rgba": np.empty((pixels, 4), np.uint8) if camera["color"] else None,
            "depth": np.empty(pixels, np.float32),
            "ids": np.empty(pixels, np.int32),
            "normals": np.empty((pixels, 3), np.float32) if camera["normals"] else None,
            # one more than needed: an empty array has no address
            "models": np.empty((instances + 1, 12), np.float32),
            "turns": np.empty((instances + 1, 9), np.float32),
            "lamp_shadow": None,
            "reads": np.empty((tiles, _MAPS, 4), np.int32),
        }
        self._structure = _Kept(**{name: address(array) for name, array in self._arrays.items()}, instances=instances)
