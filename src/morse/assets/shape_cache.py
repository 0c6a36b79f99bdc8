"""Caches of computed collision shapes: for scenes and robots of this process, and on disk for other processes."""

from __future__ import annotations

import hashlib
from collections import OrderedDict
from functools import cache
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from morse.assets.cache import Cache
from morse.mathutils import portable
from morse.scene import Bounds, CollisionShape, ShapeKind

if TYPE_CHECKING:
    from collections.abc import Hashable

    from numpy.typing import NDArray

    from morse.scene import Mesh

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


#: identifies a mesh: the digest of its arrays, its stretch, its bounds
Key = tuple[bytes, tuple[float, ...], Bounds | None]

_LARGEST = 64_000_000
_CACHE = Cache("shapes", most=4096)


class _Kept(msgspec.Struct, array_like=True):
    """Shapes as columns: for each shape its kind, its size, its position and rotation, its number of vertices."""

    kinds: list[ShapeKind]
    sizes: list[tuple[float, ...]]
    poses: bytes
    counts: list[int]
    vertices: bytes
    warnings: tuple[str, ...]


_DECODER = msgspec.msgpack.Decoder(_Kept)
_ENCODER = msgspec.msgpack.Encoder()


def load_shapes(key: Key) -> Found | None:
    """The shapes and warnings of a mesh, if an earlier process has stored them; a damaged file counts as missing."""
    data = _CACHE.get(_name(key), _LARGEST)
    if data is None:
        return None
    try:
        return _decoded(data)
    except (ValueError, TypeError, msgspec.MsgspecError):
        return None


def store_shapes(key: Key, shapes_and_warnings: Found) -> None:
    """Store the shapes and warnings of a mesh."""
    shapes, warnings = shapes_and_warnings
    poses = np.array([[*shape.position, *shape.rotation] for shape in shapes])
    points = [shape.vertices for shape in shapes if shape.vertices is not None]
    entry = _Kept(
        kinds=[shape.kind for shape in shapes],
        sizes=[shape.size for shape in shapes],
        poses=poses.tobytes(),
        counts=[0 if shape.vertices is None else len(shape.vertices) for shape in shapes],
        vertices=np.concatenate(points).astype(np.float64).tobytes() if points else b"",
        warnings=warnings,
    )
    data = _ENCODER.encode(entry)
    _CACHE.put(_name(key), hashlib.blake2b(data, digest_size=16).digest() + data)


def _decoded(data: bytes) -> Found:
    if hashlib.blake2b(data[16:], digest_size=16).digest() != data[:16]:
        raise ValueError("the file is damaged")
    entry = _DECODER.decode(data[16:])
    poses: list[Any] = np.frombuffer(entry.poses).reshape(-1, 12).tolist()
    vertices = np.frombuffer(entry.vertices).reshape(-1, 3).copy()
    shapes: list[CollisionShape] = []
    start = 0
    for kind, size, pose, count in zip(entry.kinds, entry.sizes, poses, entry.counts, strict=True):
        points = vertices[start : start + count] if count else None
        start += count
        shapes.append(CollisionShape(kind, size, tuple(pose[:3]), tuple(pose[3:]), points))
    return tuple(shapes), entry.warnings


def _name(key: Key) -> str:
    content, stretch, bounds = key
    text = f"{' '.join(map(float.hex, stretch))} {bounds and bounds.name}"
    return hashlib.blake2b(_program() + content + text.encode(), digest_size=20).hexdigest()


@cache
def _program() -> bytes:
    """A digest of the code that computes shapes: the results of another version are not used."""
    folder = Path(__file__).parent
    digest = hashlib.blake2b(f"{np.__version__}".encode())
    for file in sorted([*folder.glob("shapes/*.py"), folder / "collision.py", Path(portable.__file__), Path(__file__)]):
        digest.update(file.read_bytes())
    return digest.digest()
