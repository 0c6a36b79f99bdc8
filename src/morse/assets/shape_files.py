"""Collision shapes on disk, so that other processes do not compute the shapes of the same mesh again."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np

from morse.assets.cache import Cache
from morse.mathutils import portable
from morse.scene import Bounds, CollisionShape, ShapeKind

if TYPE_CHECKING:
    from morse.assets.shape_cache import Found

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


def get(key: Key) -> Found | None:
    """The shapes and warnings of a mesh, if an earlier process has stored them; a damaged file counts as missing."""
    data = _CACHE.get(_name(key), _LARGEST)
    if data is None:
        return None
    try:
        return _decoded(data)
    except (ValueError, TypeError, msgspec.MsgspecError):
        return None


def put(key: Key, shapes_and_warnings: Found) -> None:
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
