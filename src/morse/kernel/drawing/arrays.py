"""The arrays of a drawing, for the C functions and numpy; the twin of ``c/drawing.h``."""

from __future__ import annotations

from functools import lru_cache
from itertools import accumulate
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils import portable

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: pixels along the side of a tile
TILE = 32
#: maximum number of triangles of a cluster
CLUSTER = 256
#: flags of a material
SHADELESS, DOUBLE_SIDED, MASKED, DITHERED, HAZED, FINE = 1, 2, 4, 8, 16, 32
#: flags of a part
MOVES, MIRRORED, SOLID = 1, 2, 4
#: closed parts of a mesh: of one material slot, and of several
CLOSED, MIXED = 1, 2
#: kinds of lamps
SUN, POINT, SPOT, HEMISPHERE = range(4)
#: larger than the distance of any surface from the sun
NO_SURFACE = -1e30
#: texels along the side of a block of a shadow map whose changes are counted
_CHANGE_BLOCK = 32
#: texels along the side of a block of a shadow map, and along that of the smallest map whose blocks have bounds
_SHADOW_BLOCK, _SMALLEST_BOUNDED = 8, 16

VERTEX = np.dtype([("p", "f4", 3), ("n", "f4", 3), ("uv", "f4", 2)])
MATERIAL = np.dtype(
    [
        ("color", "f4", 4),
        ("emission", "f4", 3),
        ("metallic", "f4"),
        ("roughness", "f4"),
        ("texture", "i4"),
        ("flags", "i4"),
        ("spare", "i4"),
    ]
)
TEXTURE = np.dtype([("width", "i4"), ("height", "i4"), ("levels", "i4"), ("spare", "i4"), ("first", "i4", 16)])
LAMP = np.dtype(
    [
        ("kind", "f4"),
        ("place", "f4", 3),
        ("towards", "f4", 3),
        ("color", "f4", 3),
        ("decay", "f4"),
        ("outer", "f4"),
        ("inner", "f4"),
        ("ground", "f4", 3),
    ]
)
#: a light of the classic look, see ``c/drawing.h``
CLASSIC_LIGHT = np.dtype(
    [
        ("place", "f4", 3),
        ("towards", "f4", 3),
        ("ambient", "f4", 3),
        ("diffuse", "f4", 3),
        ("specular", "f4", 3),
        ("attenuation", "f4", 3),
        ("cutoff", "f4"),
        ("exponent", "f4"),
        ("frame", "f4", 16),
        ("directional", "i4"),
        ("number", "i4"),
        ("width", "i4"),
        ("height", "i4"),
        ("shadow", "u8"),
        ("bounds", "u8"),
        ("version", "i8"),
    ]
)
#: maximum number of lights of the classic look that cast shadows
MOST_SHADOWS = 4
#: the rest of the classic look
CLASSIC = np.dtype(
    [
        ("light_count", "i4"),
        ("shadow_count", "i4"),
        ("sky", "i4"),
        ("hazy", "i4"),
        ("foggy", "i4"),
        ("haze", "f4", 3),
        ("ring", "f4"),
        ("far", "f4"),
        ("plane", "f4", 4),
        ("background", "f4", 3),
        ("fog", "f4", 3),
        ("fog_start", "f4"),
        ("fog_end", "f4"),
    ]
)
CAMERA = np.dtype(
    [
        ("fx", "f4"),
        ("fy", "f4"),
        ("cx", "f4"),
        ("cy", "f4"),
        ("near", "f4"),
        ("far", "f4"),
        ("axes", "f4", 9),
        ("eye", "f4", 3),
        ("exposure", "f4"),
        ("tolerance", "f4"),
        ("width", "i4"),
        ("height", "i4"),
        ("tile", "i4"),
        ("color", "i4"),
        ("normals", "i4"),
        ("pixel", "i8"),
        ("parallel", "i4"),
    ],
    align=True,
)
#: which bytes of a `CAMERA` are numbers: those in between have any value
_OF_CAMERA = np.concatenate([np.arange(at[1], at[1] + at[0].itemsize) for at in (CAMERA.fields or {}).values()])
#: the bytes of ``Seen`` and ``Chunk`` in ``c/drawing.h``
SEEN, CHUNK = np.dtype("V64"), np.dtype("V24")

#: positions of the samples in a pixel, relative to its centre; the first sample, for depth and id, is the centre
SAMPLES = {1: ((0.0, 0.0),), 5: ((0.0, 0.0), (-0.4, -0.2), (-0.2, 0.4), (0.2, -0.4), (0.4, 0.2))}


def _encoded() -> NDArray[np.uint8]:
    light = np.arange(4096) / 4095
    codes = np.where(light <= 0.0031308, light * 12.92, 1.055 * portable.power(light, 1 / 2.4) - 0.055)
    return (codes * 255 + 0.5).astype(np.uint8)


#: (4096,) steps of linear light as sRGB
ENCODED = _encoded()
#: (4096,) the same without gamma correction, in the classic look
PLAIN_CODES = ((np.arange(4096) * 255 + 2047) // 4095).astype(np.uint8)


class Drawing(NamedTuple):
    """Everything that is drawn.

    Attributes:
        vertices: (V,) `VERTEX`: position, normal and texture coordinates, in the frames of the meshes.
        triangles: (T, 4) int32, three vertices, relative to the first of the cluster, and the material slot.
        clusters: (C, 4) int32, first vertex, number of vertices, first triangle, number of triangles.
        spheres: (C, 4) float32, centre and radius.
        parts: (P, 4) int32: cluster, instance, first entry in `slots`, flags (`MOVES`, `MIRRORED`, `SOLID` if no
            material of the instance has holes).
        slots: (S,) int32, the material of each slot of each instance.
        materials: (M,) `MATERIAL`.
        texels: (N,) int32, all levels of all textures; each row ends with a copy of its first texel.
        textures: (X,) `TEXTURE`.
        closed: (T,) uint8, `CLOSED` or `MIXED` for triangles of closed parts of a mesh. Their back faces are not
            visible from outside, and are left out unless the surface has holes.
        guards: (C,) float32, radius of the sphere around the centre of the cluster that contains these parts.
        levels: (C, 6) float32, centre and radius of a sphere around the mesh, and the errors of the level of detail to
            which the cluster belongs and of the next one, m. A level is drawn if its error is allowed and that of the
            next one is not; the allowed error is `CAMERA` ``tolerance`` times the depth of the nearest point of the
            sphere.
        maps: (M, 4) float32, factors and offsets of the texture coordinates u and v of each material; None for those of
            the vertices.
    """

    vertices: NDArray[np.void]
    triangles: NDArray[np.int32]
    clusters: NDArray[np.int32]
    spheres: NDArray[np.float32]
    parts: NDArray[np.int32]
    slots: NDArray[np.int32]
    materials: NDArray[np.void]
    texels: NDArray[np.int32]
    textures: NDArray[np.void]
    closed: NDArray[np.uint8]
    guards: NDArray[np.float32]
    levels: NDArray[np.float32]
    maps: NDArray[np.float32] | None = None


class Poses(NamedTuple):
    """The poses of the instances.

    Attributes:
        models: (I, 12) float32, mesh to world, 3x4 row by row.
        turns: (I, 9) float32, the same for normals, 3x3.
    """

    models: NDArray[np.float32]
    turns: NDArray[np.float32]


class Light(NamedTuple):
    """The lighting of a scene.

    Attributes:
        lamps: (L,) `LAMP`.
        sky: (20,) float32, RGB of horizon, zenith, ground and glow, direction to the sun, begin and depth of mist,
            and 1 if surfaces look as in MORSE 1.4: lamps multiply codes of sRGB, nothing is mirrored, no tones are
            mapped, and ``decay`` of a lamp is the distance of half of its light, m.
        sun: (16,) float32, world to the shadow map: three rows of a 3x4 matrix, and the width of a texel, m.
            If the next number is positive, surfaces from the distance after it on are left out.
        shadow: (H, W) float32, distance of the nearest surface from the sun, m; None without shadows.
        near_sun, near_shadow: a finer map of a part of the world, or None; it has priority over the other map.
        lamp_frame: (16,) float32, world to the shadow map of the spot lamps whose ``ground`` begins with 1: three rows
            of a 3x4 projection to (column x depth, row x depth, depth), and the width of a texel at a depth of 1 m.
        lamp_shadow: (H, W) float32, minus the depth of the nearest surface, m; None without it.
        shadow_bounds, near_bounds, lamp_bounds: (H / 8, W / 8, 4) float32, rounded up: two planes for each block of
            8 x 8 texels of these maps, between which all texels are that are read for a point in the block: their
            change for a column and a row, and their values at the first texel of the block, m. They only save time;
            see `bounds_for`.
        shadow_changes, near_changes: (N,) int64, numbers of the last changes of these maps; see `changes_for`.
        classic: (1,) `CLASSIC`, the look of the fixed pipeline of OpenGL instead of all of the above, without gamma
            correction; None for the look of scenes.
        classic_lights: (L,) `CLASSIC_LIGHT`; ``shadow`` and ``bounds`` are the addresses of arrays that the caller
            keeps.
    """

    lamps: NDArray[np.void]
    sky: NDArray[np.float32]
    sun: NDArray[np.float32]
    shadow: NDArray[np.float32] | None
    near_sun: NDArray[np.float32] | None = None
    near_shadow: NDArray[np.float32] | None = None
    lamp_frame: NDArray[np.float32] | None = None
    lamp_shadow: NDArray[np.float32] | None = None
    shadow_bounds: NDArray[np.float32] | None = None
    near_bounds: NDArray[np.float32] | None = None
    lamp_bounds: NDArray[np.float32] | None = None
    shadow_changes: NDArray[np.int64] | None = None
    near_changes: NDArray[np.int64] | None = None
    classic: NDArray[np.void] | None = None
    classic_lights: NDArray[np.void] | None = None


def changes_for(shadow: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return memory for the numbers of the last changes of a shadow map: of each block of texels, then of all."""
    height, width = shadow.shape
    return np.zeros(-(-height // _CHANGE_BLOCK) * -(-width // _CHANGE_BLOCK) + 1, np.int64)


def bounds_shape(height: int, width: int) -> tuple[int, int] | None:
    """Return the numbers of blocks of a shadow map that have bounds; None for the smallest maps, without bounds."""
    if min(height, width) < _SMALLEST_BOUNDED:
        return None
    return -(-height // _SHADOW_BLOCK), -(-width // _SHADOW_BLOCK)


def bounds_for(shadow: NDArray[np.float32]) -> NDArray[np.float32] | None:
    """Return memory for the bounds of a shadow map, which exclude no texel; None for the smallest maps."""
    shape = bounds_shape(*shadow.shape)
    if shape is None:
        return None
    bounds = np.zeros((*shape, 4), np.float32)
    bounds[..., 2:] = -np.inf, np.inf
    return bounds


class Pictures(NamedTuple):
    """The images of cameras, one after the other.

    Attributes:
        rgba: (N, 4) uint8, opaque; undefined for cameras without colour.
        depth: (N,) float32, metres along the axis, 0 without a surface.
        ids: (N,) int32, index of the instance, -1 without a surface.
        normals: (N, 3) float32, unit vectors along the axes of the camera, 0 without a surface; undefined for cameras
            without normals.
    """

    rgba: NDArray[np.uint8]
    depth: NDArray[np.float32]
    ids: NDArray[np.int32]
    normals: NDArray[np.float32]


def bytes_of_cameras(cameras: NDArray[np.void]) -> NDArray[np.uint8]:
    """(K, B) the numbers of cameras (K,) `CAMERA`, to compare them."""
    whole = np.ascontiguousarray(cameras).view(np.uint8).reshape(len(cameras), CAMERA.itemsize)
    return np.asarray(whole.take(_OF_CAMERA, axis=1))


def number_tiles(cameras: NDArray[np.void]) -> tuple[int, int]:
    """Set the first tile and pixel of each camera; return the numbers of all tiles and pixels."""
    sizes = tuple(zip(cameras["width"].tolist(), cameras["height"].tolist(), strict=True))
    cameras["tile"], cameras["pixel"], tiles, pixels = _tiles_of_sizes(sizes)
    return tiles, pixels


@lru_cache(maxsize=16)
def _tiles_of_sizes(sizes: tuple[tuple[int, int], ...]) -> tuple[list[int], list[int], int, int]:
    """The first tile and pixel of each image, and the numbers of all of them."""
    tiles = [0, *accumulate(-(-width // TILE) * -(-height // TILE) for width, height in sizes)]
    pixels = [0, *accumulate(width * height for width, height in sizes)]
    return tiles[:-1], pixels[:-1], tiles[-1], pixels[-1]
