"""A linkage by a C function."""

from __future__ import annotations

import ctypes
from ctypes import c_double, c_int64, c_void_p
from typing import TYPE_CHECKING

from morse.kernel.memory import addresses

if TYPE_CHECKING:
    from morse.kernel.linkage.arrays import LinkageArrays

_BONES = "parents kinds axes places turns moves frames"
_OBJECTS = "outers hooks held locals poses"
_SHAPES = "geoms owners mounts geom_positions geom_quaternions geom_radii geom_boxes"


def _pointers(names: str) -> list[tuple[str, type]]:
    return [(name, c_void_p) for name in names.split()]


class _Structure(ctypes.Structure):
    """``Linkage`` of ``c/linkage.c``."""

    _fields_ = (
        ("bones", c_int64),
        *_pointers(_BONES),
        ("objects", c_int64),
        *_pointers(_OBJECTS),
        ("shapes", c_int64),
        *_pointers(_SHAPES),
        ("all_shapes", c_int64),
        *_pointers("all_geoms base up"),
        ("reach", c_double),
        ("lowest", c_double),
    )


class NativeLinkage:
    """See `morse.kernel.linkage.arrays.LinkageWork`."""

    def __init__(self, library: ctypes.CDLL, arrays: LinkageArrays) -> None:
        self._arrays = arrays
        names = f"{_BONES} {_OBJECTS} {_SHAPES} all_geoms base up".split()
        self._structure = _Structure(
            bones=len(arrays.parents),
            objects=len(arrays.outers),
            shapes=len(arrays.geoms),
            all_shapes=len(arrays.all_geoms),
            **dict(zip(names, addresses(*(getattr(arrays, name) for name in names)), strict=True)),
        )
        self._all = ctypes.byref(self._structure)
        self._move = library.morse_linkage
        self._move.restype = None

    def move(self) -> tuple[float, float]:
        """Fill the results, and place the shapes."""
        structure = self._structure
        self._move(self._all)
        return structure.reach, structure.lowest
