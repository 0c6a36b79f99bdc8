"""The structures of ``c/solids.h``, ``c/mesh.h`` and ``c/rays_place.c``."""

from __future__ import annotations

import ctypes
from ctypes import c_double, c_int32, c_int64, c_void_p

import numpy as np

#: bytes of a node of a tree
NODE = np.dtype((np.void, 224))
#: four triangles: corner, axis, triangle
BLOCK = np.dtype({"names": ["corners", "faces"], "formats": [("f8", (3, 3, 4)), ("i4", 4)], "itemsize": 320})


def _addresses(names: str) -> list[tuple[str, type]]:
    return [(name, c_void_p) for name in names.split()]


class MeshStructure(ctypes.Structure):
    """``Mesh``."""

    _fields_ = _addresses("nodes blocks")


class SolidsStructure(ctypes.Structure):
    """``Solids``."""

    _fields_ = _addresses("kinds positions rotations sizes meshes still moving still_leaves moving_leaves")


class PlacingStructure(ctypes.Structure):
    """``Placing``."""

    _fields_ = _addresses(
        "slot_positions slot_rotations anchor slots places turns centres halves kinds positions rotations"
    )


class GatheringStructure(ctypes.Structure):
    """``Gathering``."""

    _fields_ = (("count", c_int32), *_addresses("members boxes scratch nodes leaves"))


class RaysStructure(ctypes.Structure):
    """``Rays``."""

    _fields_ = (
        ("rays", c_int64),
        *_addresses("slot_positions slot_rotations anchor slots offsets turns"),
        ("upright", c_int64),
        *_addresses("directions origins owners groups"),
        ("limit", c_double),
        *_addresses("distances solids faces"),
        ("next", c_int64),
    )
