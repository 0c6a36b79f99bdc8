"""The skins of MJCF files, drawn in pieces: each moves with a body.

A skin is a mesh whose vertices follow several bodies, each with a weight. Here, a triangle moves with the bodies that
its corners follow most. Triangles between two bodies belong to both, so that the pieces overlap where a joint bends.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from morse.mathutils import Quaternion
from morse.mathutils.portable import matmul

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

    from numpy.typing import NDArray


#: largest number of triangles of a skin, and of its bones
_MOST_TRIANGLES, _MOST_BONES = 1_000_000, 10_000
#: largest count of numbers of all skins of a model
MOST_NUMBERS = 20_000_000
_NAME = 40


@dataclass(slots=True)
class SkinBone:
    """A body that a skin follows.

    Attributes:
        position, quaternion: pose of the body for which the skin is given, m, w x y z.
        vertices, weights: numbers of the vertices that follow it, and how much.
    """

    body: str
    position: tuple[float, ...]
    quaternion: tuple[float, ...]
    vertices: NDArray[np.int64]
    weights: NDArray[np.float64]


@dataclass(slots=True)
class Skin:
    """A skin.

    Attributes:
        vertices: (V, 3) m; triangles: (T, 3); uvs: (V, 2), v downward, or None.
        color: RGBA, or None for that of the material.
    """

    name: str
    vertices: NDArray[np.float64]
    triangles: NDArray[np.int64]
    uvs: NDArray[np.float64] | None
    bones: list[SkinBone]
    material: str
    color: tuple[float, ...] | None
    group: int

    @property
    def size(self) -> int:
        """The count of its numbers."""
        return self.vertices.size + self.triangles.size + sum(bone.vertices.size for bone in self.bones)


def read_skin(element: Element, content: bytes | None) -> Skin:
    """Read an element ``skin``.

    Args:
        content: of its file, if it names one; see ``mjCSkin::LoadSKN`` in MuJoCo.

    Raises:
        ValueError: it is damaged, or too large.
    """
    name = element.get("name") or "skin"
    vertices, uvs, triangles, bones = _from_element(element) if content is None else _from_file(content)
    count = len(vertices)
    if not count or not len(triangles) or len(triangles) > _MOST_TRIANGLES:
        raise ValueError(f"it has {count} vertices and {len(triangles)} triangles")
    if len(bones) > _MOST_BONES:
        raise ValueError(f"it has {len(bones)} bones, more than {_MOST_BONES}")
    if uvs is not None and len(uvs) != count:
        uvs = None
    arrays = (vertices, *(array for bone in bones for array in (bone.position, bone.quaternion, bone.weights)))
    if not all(np.isfinite(array).all() and np.abs(array).max(initial=0.0) < 1e6 for array in arrays):
        raise ValueError("it has numbers that are not finite, or too large")
    for numbers in (triangles, *(bone.vertices for bone in bones)):
        if numbers.size and (numbers.min() < 0 or numbers.max() >= count):
            raise ValueError("it names vertices that it does not have")
    words = element.get("rgba", "").split()
    color = tuple(min(max(float(word), 0.0), 1.0) for word in words) if len(words) == 4 else None
    group = int(element.get("group") or 0)
    return Skin(name, vertices, triangles, uvs, bones, element.get("material") or "", color, group)


_Parts = tuple["NDArray[np.float64]", "NDArray[np.float64] | None", "NDArray[np.int64]", list[SkinBone]]


def _from_element(element: Element) -> _Parts:
    bones = []
    for bone in element.iter("bone"):
        numbers, weights = _row(bone, "vertid").astype(np.int64), _row(bone, "vertweight")
        if len(numbers) != len(weights):
            raise ValueError(f"a bone has {len(numbers)} vertices and {len(weights)} weights")
        position, quaternion = _row(bone, "bindpos", 3), _row(bone, "bindquat", 4)
        bones.append(
            SkinBone(bone.get("body") or "", tuple(position.tolist()), tuple(quaternion.tolist()), numbers, weights)
        )
    uvs = _row(element, "texcoord")
    return (
        _rows(_row(element, "vertex"), 3),
        _rows(uvs, 2) if len(uvs) else None,
        _rows(_row(element, "face"), 3).astype(np.int64),
        bones,
    )


def _row(element: Element, name: str, count: int | None = None) -> NDArray[np.float64]:
    row = np.array([float(word) for word in (element.get(name) or "").split()])
    if count is not None and len(row) != count:
        raise ValueError(f"its {name} has {len(row)} numbers, expected {count}")
    return row


def _rows(row: NDArray[np.float64], width: int) -> NDArray[np.float64]:
    if len(row) % width:
        raise ValueError(f"it has {len(row)} numbers, expected a multiple of {width}")
    return row.reshape(-1, width)


def _from_file(content: bytes) -> _Parts:
    place = 0

    def take(kind: str, count: int) -> NDArray[np.generic]:
        nonlocal place
        if count < 0 or place + 4 * count > len(content):
            raise ValueError("its file is too short")
        place += 4 * count
        return np.frombuffer(content, kind, count, place - 4 * count)

    vertex_count, uv_count, triangle_count, bone_count = (int(number) for number in take("<i4", 4))
    if bone_count > _MOST_BONES:
        raise ValueError(f"it has {bone_count} bones, more than {_MOST_BONES}")
    vertices = take("<f4", 3 * vertex_count).reshape(-1, 3).astype(np.float64)
    uvs = take("<f4", 2 * uv_count).reshape(-1, 2).astype(np.float64) if uv_count else None
    triangles = take("<i4", 3 * triangle_count).reshape(-1, 3).astype(np.int64)
    bones = []
    for _ in range(bone_count):
        name = take("<i4", _NAME // 4).tobytes().partition(b"\0")[0].decode("utf-8", "replace")
        position, quaternion = take("<f4", 3).tolist(), take("<f4", 4).tolist()
        (count,) = struct.unpack("<i", take("<i4", 1).tobytes())
        numbers, weights = take("<i4", count).astype(np.int64), take("<f4", count).astype(np.float64)
        bones.append(SkinBone(name, tuple(position), tuple(quaternion), numbers, weights))
    return vertices, uvs, triangles, bones


def pieces_of(
    skin: Skin,
) -> list[tuple[SkinBone, NDArray[np.float32], NDArray[np.int32], NDArray[np.float32] | None]]:
    """Return the bones, with vertices in the frame of the body, triangles and texture coordinates of corners."""
    most, owner = np.zeros(len(skin.vertices)), np.full(len(skin.vertices), -1)
    for number, bone in enumerate(skin.bones):
        is_most = bone.weights > most[bone.vertices]
        most[bone.vertices[is_most]], owner[bone.vertices[is_most]] = bone.weights[is_most], number
    owners = owner[skin.triangles]
    owners[(owners < 0).any(axis=1)] = -1
    # the corners by owner: to look for those of each bone among all would take bones times triangles
    order = np.argsort(owners, axis=None, kind="stable")
    bounds = np.searchsorted(owners.ravel()[order], np.arange(len(skin.bones) + 1))
    pieces = []
    for number, bone in enumerate(skin.bones):
        triangles = skin.triangles[np.unique(order[bounds[number] : bounds[number + 1]] // 3)]
        if not len(triangles) or not any(bone.quaternion):
            continue
        used, corners = np.unique(triangles, return_inverse=True)
        axes = np.array([list(row) for row in Quaternion(bone.quaternion).normalized().to_matrix()])
        vertices = matmul(skin.vertices[used] - np.array(bone.position), axes).astype(np.float32)
        uvs = None
        if skin.uvs is not None:
            uvs = skin.uvs[triangles].astype(np.float32)
            uvs[..., 1] = 1.0 - uvs[..., 1]
        pieces.append((bone, vertices, corners.reshape(-1, 3).astype(np.int32), uvs))
    return pieces
