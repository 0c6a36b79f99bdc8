"""The arrays of a linkage, shared by C and Python."""

from __future__ import annotations

import ctypes
from ctypes import c_double, c_int64, c_void_p
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol

import numpy as np

from morse.kernel.loading import library
from morse.kernel.memory import addresses

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

    Integers = NDArray[np.int64]

__all__ = ["linkage"]


FIXED, REVOLUTE, PRISMATIC = range(3)


@dataclass(eq=False)
class LinkageArrays:
    """B bones, N attached objects, S collision shapes; all arrays are contiguous, and their addresses do not change.

    Poses are 12 numbers: position and rotation, row by row.

    Attributes:
        parents: (B,) index of the parent of each bone, or -1; parents come first.
        kinds: (B,) `FIXED`, `REVOLUTE` or `PRISMATIC`.
        axes: (B,) the axis of the joint in the frame of the bone, 0 to 2.
        places, turns: (B, 3) and (B, 9) pose in the frame of the parent at joint value 0.
        moves: (B, 2) cosine and sine of the value of a revolute joint; value of a prismatic joint, and 0.
        outers: (N,) index of the outer object, or -1 for the armature itself; outer objects come first.
        hooks: (N,) the bone to which an object is attached; -1 for an object that is fixed to its outer object.
        held: (N, 12) pose in the frame of the bone, or of the outer object.
        geoms: (S,) indices of the shapes in the arrays of the engine.
        owners: (S,) the object of each shape.
        mounts: (S, 12) pose of each shape in the frame of its object.
        geom_positions, geom_quaternions, geom_radii, geom_boxes: of the engine; the first two are written.
        all_geoms: the indices of all shapes of the body.
        base: (12,) pose of the armature in its body.
        up: (3,) the upward direction in the frame of the body.
        frames: (B, 12) result: poses of the bones in the frame of the armature.
        locals, poses: (N, 12) result: poses of the objects in the frame of the outer object, and in that of the body.
    """

    parents: Integers
    kinds: Integers
    axes: Integers
    places: Floats
    turns: Floats
    outers: Integers
    hooks: Integers
    held: Floats
    geoms: Integers
    owners: Integers
    mounts: Floats
    geom_positions: Floats
    geom_quaternions: Floats
    geom_radii: Floats
    geom_boxes: Floats
    all_geoms: Integers
    base: Floats = field(default_factory=lambda: np.zeros(12))
    up: Floats = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))

    def __post_init__(self) -> None:
        self.moves = np.zeros((len(self.parents), 2))
        self.moves[self.kinds == REVOLUTE, 0] = 1.0
        self.frames = np.zeros((len(self.parents), 12))
        self.locals, self.poses = np.zeros((len(self.outers), 12)), np.zeros((len(self.outers), 12))


class LinkageWork(Protocol):
    """Moves the objects and shapes of a `LinkageArrays`."""

    def move(self) -> tuple[float, float]:
        """Fill the results, and place the shapes.

        Returns:
            Distance from the origin of the body to the outermost point of the bounding spheres of its shapes, m; height
            of the lowest point of the bounding boxes of the moved shapes above the origin, m.
        """


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
    """See `morse.kernel.linkage.LinkageWork`."""

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


def linkage(arrays: LinkageArrays) -> LinkageWork:
    """The function that moves a linkage."""
    return NativeLinkage(library(), arrays)
