"""Pieces of a mesh: built and placed separately, then joined into one object."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    import bpy


@dataclass(frozen=True)
class Part:
    """A closed or open surface with one material.

    Attributes:
        vertices: (V, 3) metres.
        faces: vertex indices of each polygon, counter-clockwise when viewed from outside.
        uvs: (u, v) of each corner of each face, or None without a texture.
        smooth: smooth shading; hard edges have separate vertices.
    """

    vertices: np.ndarray
    faces: list[tuple[int, ...]]
    material: bpy.types.Material | None = None
    uvs: list[np.ndarray] | None = None
    smooth: bool = True

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Part:
        return replace(self, vertices=self.vertices + np.array([x, y, z]))

    def turned(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Part:
        """Rotated about the origin: about X first, then Y, then Z; degrees."""
        return replace(self, vertices=self.vertices @ rotation(x, y, z).T)

    def scaled(self, x: float = 1.0, y: float | None = None, z: float | None = None) -> Part:
        factors = np.array([x, x if y is None else y, x if z is None else z])
        faces, uvs = self.faces, self.uvs
        if np.prod(factors) < 0:  # a mirror image turns its faces inside out
            faces = [face[::-1] for face in faces]
            uvs = None if uvs is None else [corners[::-1] for corners in uvs]
        return replace(self, vertices=self.vertices * factors, faces=faces, uvs=uvs)

    def painted(self, material: bpy.types.Material) -> Part:
        return replace(self, material=material)

    def flat(self) -> Part:
        return replace(self, smooth=False)

    def mapped(self, metres: float, grain: int | None = None, offset: Sequence[float] = (0.0, 0.0)) -> Part:
        """Texture coordinates by projection along the main axis of each face.

        Args:
            metres: length that the image covers.
            grain: axis (0, 1, 2) of the image's u direction where the face allows it.
        """
        uvs = []
        for face in self.faces:
            corners = self.vertices[list(face)]
            normal = np.abs(face_normal(corners))
            axes = [axis for axis in range(3) if axis != int(np.argmax(normal))]
            if grain is not None and axes[1] == grain:
                axes.reverse()
            uvs.append(corners[:, axes] / metres + np.asarray(offset))
        return replace(self, uvs=uvs)

    def stretched_over(self, axes: tuple[int, int]) -> Part:
        """Texture coordinates that lay the whole image over the extent along two axes."""
        low, high = self.vertices.min(axis=0), self.vertices.max(axis=0)
        extent = np.where(high - low > 1e-9, high - low, 1.0)
        unit = ((self.vertices - low) / extent)[:, list(axes)]
        return replace(self, uvs=[unit[list(face)] for face in self.faces])


def face_normal(corners: np.ndarray) -> np.ndarray:
    """Area normal (Newell's sum, for any polygon)."""
    return np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)


def rotation(x: float, y: float, z: float) -> np.ndarray:
    """3x3 rotation Rz Ry Rx of angles in degrees."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians([x, y, z])), np.sin(np.radians([x, y, z]))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def bounds(parts: Sequence[Part]) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest corner of the box around all parts."""
    lows, highs = zip(*((p.vertices.min(axis=0), p.vertices.max(axis=0)) for p in parts), strict=True)
    return np.min(lows, axis=0), np.max(highs, axis=0)


def fitted(parts: Sequence[Part], size: Sequence[float], centre: Sequence[float]) -> list[Part]:
    """The parts, stretched slightly so that their bounding box has exactly this size and position."""
    low, high = bounds(parts)
    have = high - low
    factor = np.where(have > 1e-9, np.asarray(size) / np.where(have > 1e-9, have, 1.0), 1.0)
    return [replace(p, vertices=(p.vertices - (low + high) / 2) * factor + np.asarray(centre)) for p in parts]


def mirrored(parts: Sequence[Part]) -> list[Part]:
    """The parts and their mirror images on the other side (left and right)."""
    return [*parts, *(part.scaled(1, -1, 1) for part in parts)]


def mirrored_x(parts: list[Part]) -> list[Part]:
    """The parts and their mirror images at the other end of X."""
    return [*parts, *(part.scaled(-1, 1, 1) for part in parts)]


def in_frame_of(parts: Sequence[Part], turned: Sequence[float]) -> list[Part]:
    """Convert parts in the axes of the world to the frame of an object with this Euler XYZ rotation (rad)."""
    frame = rotation(*np.degrees(turned))
    return [replace(part, vertices=part.vertices @ frame) for part in parts]
