"""Converts meshes and materials of trimesh to those of a scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from morse.assets.pictures import Pictures
from morse.assets.polygons import Polygons, corner_normals
from morse.assets.shapes.surface import without_equal_triangles
from morse.mathutils.portable import linear_color, matmul
from morse.scene import Image, Material, Mesh

#: triangles per vertex of a closed surface: with more, some may be equal
_USUAL = 2
#: rad; edges with a larger angle are shown as creases
_CREASE = 0.7
#: colour without a material, sRGB and opacity
_GREY = (204, 204, 204, 255)


class Surfaces:
    """Converts each mesh, material and image once.

    Args:
        turn: (3, 3) rotation from the axes of the file to those of MORSE.
        is_linear: whether colours are linear light, as in glTF; the programs for other formats show the numbers as
            they are.

    Attributes:
        images: by name of the first material that shows them.
    """

    def __init__(self, turn: object, *, is_linear: bool) -> None:
        self._turn, self._is_linear = np.asarray(turn, dtype=np.float32), is_linear
        self._meshes: dict[int, Mesh] = {}
        self._materials: dict[int, Material] = {}
        self.images: dict[str, Image] = {}
        self._pictures = Pictures()

    @property
    def warnings(self) -> list[str]:
        """Pictures that a chequered pattern replaces."""
        return self._pictures.warnings

    def mesh(self, name: str, source: object) -> Mesh:
        """Triangles with normals and texture coordinates.

        Raises:
            ValueError: a coordinate is not a finite number.
        """
        if id(source) not in self._meshes:
            self._meshes[id(source)] = self._converted(name, source)
        return self._meshes[id(source)]

    def _converted(self, name: str, source: Any) -> Mesh:
        with np.errstate(over="ignore", invalid="ignore"):  # refused below
            vertices = matmul(np.asarray(source.vertices, dtype=np.float32).reshape(-1, 3), self._turn.T)
        triangles = np.ascontiguousarray(source.faces, dtype=np.int32).reshape(-1, 3)
        if not np.isfinite(vertices).all():
            raise ValueError(f"the mesh '{name}' has coordinates that are not finite numbers")
        if triangles.size and (triangles.min() < 0 or triangles.max() >= len(vertices)):
            raise ValueError(f"the mesh '{name}' has triangles whose corners are missing")
        a, b, c = triangles.T
        triangles = triangles[(a != b) & (b != c) & (a != c)]
        if len(triangles) > _USUAL * len(vertices):
            triangles = without_equal_triangles(triangles)
        uvs = getattr(source.visual, "uv", None)
        if uvs is not None:
            uvs = np.asarray(uvs, dtype=np.float32)
            uvs = uvs[triangles] if uvs.shape == (len(vertices), 2) and np.isfinite(uvs).all() else None
        return Mesh(
            name=name,
            vertices=vertices,
            triangles=triangles,
            material_index=np.zeros(len(triangles), np.int32),
            uvs=uvs,
            normals=_normals(vertices, triangles),
            materials=(self._material(name, source.visual),),
        )

    def _material(self, name: str, visual: object) -> Material:
        material = getattr(visual, "material", None)
        if material is None:
            return Material(name, linear_color(_numbers(getattr(visual, "main_color", None), 4, _GREY) / 255.0))
        if id(material) not in self._materials:
            self._materials[id(material)] = self._of(name, material, visual)
        return self._materials[id(material)]

    def _of(self, name: str, material: Any, visual: object) -> Material:
        own = str(getattr(material, "name", None) or name)
        if hasattr(material, "baseColorFactor"):
            color = _numbers(material.baseColorFactor, 4, (255, 255, 255, 255)) / 255.0
            roughness, metallic = (
                float(np.clip(_numbers(value, 1, (1.0,))[0], 0.0, 1.0))
                for value in (material.roughnessFactor, material.metallicFactor)
            )
            glow = np.clip(_numbers(material.emissiveFactor, 3, (0.0, 0.0, 0.0)), 0.0, 100.0)
            picture, is_double = material.baseColorTexture, bool(material.doubleSided)
        else:
            color = _numbers(getattr(material, "diffuse", None), 4, _GREY) / 255.0
            roughness, metallic, glow = 0.6, 0.0, np.zeros(3)
            picture, is_double = getattr(material, "image", None), True
            if picture is not None and getattr(visual, "uv", None) is not None:
                color = np.ones(4)
        r, g, b, alpha = (float(part) for part in np.clip(color, 0.0, 1.0))
        return Material(
            own,
            (r, g, b, alpha) if self._is_linear else linear_color((r, g, b, alpha)),
            metallic=metallic,
            roughness=roughness,
            emission=(float(glow[0]), float(glow[1]), float(glow[2])),
            image=None if picture is None else self._image(own, picture),
            double_sided=is_double,
        )

    def _image(self, name: str, picture: object) -> Image:
        image = self._pictures.image(name, picture)
        self.images.setdefault(image.name, image)
        return image


def _normals(vertices: Any, triangles: Any) -> Any:
    """(T, 3, 3) normals of the corners, smooth except at creases; equal positions are one vertex, as in STL files."""
    if not len(triangles):
        return None
    _, same = np.unique(vertices, axis=0, return_inverse=True)
    count = len(triangles)
    polygons = Polygons(
        vertices=vertices.astype(np.float64)[np.unique(same, return_index=True)[1]],
        corners=same.reshape(-1)[triangles.ravel()].astype(np.int64),
        sizes=np.full(count, 3, np.int64),
        materials=np.zeros(count, np.int64),
        smooth=np.ones(count, bool),
        uvs=None,
        sharp=np.zeros((0, 2), np.int64),
    )
    normals = corner_normals(polygons, _CREASE)
    return None if normals is None else normals.astype(np.float32).reshape(count, 3, 3)


def _numbers(values: object, count: int, default: tuple[float, ...]) -> Any:
    """Some numbers, or the default if there are no numbers or too few."""
    if values is None:
        return np.array(default, dtype=float)
    array = np.asarray(values, dtype=float).ravel()
    if array.size == count - 1 and count == 4:
        array = np.append(array, default[3])
    return array if array.size == count and np.isfinite(array).all() else np.array(default, dtype=float)
