"""Cache of computed collision shapes, for scenes that are loaded again and robots that are spawned."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from threading import Lock
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Hashable

    from numpy.typing import NDArray

    from morse.scene import CollisionShape, Mesh

    #: the shapes of a mesh, and warnings about them
    Found = tuple[tuple[CollisionShape, ...], tuple[str, ...]]

_SHAPE_BYTES = 300  # a shape without its points


class ShapeCache:
    """Results by content, the one that was used last at the end; if the cache is full, the first ones are removed.

    Shapes are shared between scenes, because computed shapes are never modified.

    Args:
        most: maximum size of all results together, bytes.
    """

    def __init__(self, most: int = 64_000_000) -> None:
        self._most = most
        self._size = 0
        self._results: OrderedDict[Hashable, Found] = OrderedDict()
        self._lock = Lock()

    def get(self, key: Hashable) -> Found | None:
        """The result that was stored under the key; None if it was removed."""
        with self._lock:
            entry = self._results.get(key)
            if entry is not None:
                self._results.move_to_end(key)
            return entry

    def put(self, key: Hashable, entry: Found) -> None:
        """Store a result."""
        with self._lock:
            if key in self._results:
                return
            self._results[key] = entry
            self._size += _size(entry)
            while self._size > self._most:
                _, oldest = self._results.popitem(last=False)
                self._size -= _size(oldest)


def content(mesh: Mesh) -> bytes:
    """A digest of the vertices and triangles of a mesh: equal for equal arrays, in whatever object."""
    digest = hashlib.blake2b(digest_size=32)
    for array in (mesh.vertices, mesh.triangles):
        _add(digest, np.asarray(array))
    return digest.digest()


def _add(digest: hashlib.blake2b, array: NDArray[np.generic]) -> None:
    digest.update(f"{array.dtype.str} {array.shape} ".encode())
    digest.update(np.ascontiguousarray(array).tobytes())


def _size(entry: Found) -> int:
    shapes, _ = entry
    return _SHAPE_BYTES + sum(
        _SHAPE_BYTES + (0 if shape.vertices is None else shape.vertices.nbytes) for shape in shapes
    )
