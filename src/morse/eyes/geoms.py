"""The abstract geoms of a `mujoco.MjvScene` as an array, and as instances of shapes."""

from __future__ import annotations

import ctypes
import math
from functools import lru_cache
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

import mujoco
import numpy as np

from morse.eyes.shapes import GRID_REACH
from morse.eyes.store import CUBE, FLAT, SKY, ModelStore
from morse.kernel.drawing.arrays import DOUBLE_SIDED, FINE, HAZED, MATERIAL, SOLID, Poses
from morse.mathutils.portable import linear_light

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.eyes.picture import View
    from morse.eyes.store import Key, Prepared

# Types of geoms in MuJoCo (`mujoco.mjtGeom`), the same in all versions.
PLANE, HFIELD, SPHERE, CAPSULE, ELLIPSOID, CYLINDER, BOX, MESH, SDF = range(9)
ARROW, ARROW1, ARROW2, LINE, LINEBOX, FLEX, SKIN, LABEL, TRIANGLE = range(100, 109)

#: before that version of MuJoCo, textures are projected along Z onto planes, boxes, spheres and the like, with their
#: middle at that of the geom; since then, they begin at a corner of planes, and are wrapped around the others
_TEXTURES_BEGIN_AT_CORNERS = (3, 12)
_TEXTURES_ARE_CENTRED = tuple(map(int, mujoco.__version__.split(".")[:2])) < _TEXTURES_BEGIN_AT_CORNERS

#: the fields of `mujoco.MjvGeom` that are read
_FIELDS = {
    **dict.fromkeys(("type", "dataid", "objtype", "objid", "category", "matid", "texid", "texuniform"), "i4"),
    **dict.fromkeys(("texcoord", "segid"), "i4"),
    "size": ("f4", 3),
    "pos": ("f4", 3),
    "mat": ("f4", 9),
    "rgba": ("f4", 4),
    **dict.fromkeys(("emission", "specular", "shininess", "reflectance"), "f4"),
    "texrepeat": ("f4", 2),
    "castshadow": "u1",
    "modelrbound": "f4",
}
#: the fields of `mujoco.MjvLight` that are read; before MuJoCo 3.3, `directional` is instead of `type`
_FIELDS_OF_LIGHTS = {
    "type": "i4",
    **dict.fromkeys(("directional", "headlight", "castshadow"), "u1"),
    **dict.fromkeys(("pos", "dir", "attenuation", "ambient", "diffuse", "specular"), ("f4", 3)),
    **dict.fromkeys(("cutoff", "exponent"), "f4"),
}
#: the fields that geoms have from MuJoCo 3.11 on; before, only their materials have them
_OF_MATERIALS = ("texid", "texuniform", "texrepeat")
#: which of the textures of a material is that of its colour
_RGB = 1
#: the fields on which the instances depend, but not their poses
_LOOKS = (
    *(
        "type",
        "dataid",
        "objid",
        "segid",
        "matid",
        "texid",
        "texuniform",
        "texcoord",
        "size",
        "rgba",
        "emission",
        "specular",
    ),
    *("shininess", "reflectance", "texrepeat", "castshadow"),
)


def _address(values: NDArray[np.generic]) -> int:
    return int(values.__array_interface__["data"][0])


@lru_cache(maxsize=2)
def _layout(make: Any, kind: str) -> tuple[np.dtype[np.void], int]:
    """Where the fields of geoms or lights are in memory: each version of MuJoCo has its own structures."""
    geoms = getattr(make(), kind)
    first, stride = _address(geoms[1].pos), _address(geoms[1].pos) - _address(geoms[0].pos)
    # the memory before and after the position of the second of three geoms belongs to the array
    window = (ctypes.c_ubyte * (2 * stride)).from_address(first - stride)
    names, formats, offsets = [], [], []
    for name, form in (_FIELDS if kind == "geoms" else _FIELDS_OF_LIGHTS).items():
        value = getattr(geoms[1], name, None)
        if value is None:
            continue
        if isinstance(value, np.ndarray):
            offset = _address(value) - first
        else:
            # one byte of a small integer, or three of a float, differ
            setattr(geoms[1], name, 0)
            before = bytes(window)
            setattr(geoms[1], name, 1)
            changed = np.flatnonzero(np.frombuffer(before, np.uint8) != np.frombuffer(bytes(window), np.uint8))
            setattr(geoms[1], name, 0)
            # 1.0 is 00 00 80 3f
            offset = int(changed[0]) - stride - (2 if form == "f4" else 0)
        names.append(name)
        formats.append(form)
        offsets.append(offset)
    start = min(offsets)
    return np.dtype(
        {"names": names, "formats": formats, "offsets": [at - start for at in offsets], "itemsize": stride}
    ), start


def _array_of(scene: Any, make: Any, kind: str) -> NDArray[Any]:
    """The geoms or lights for which a scene has room; the array shares the memory of the scene."""
    elements, (layout, start) = getattr(scene, kind), _layout(make, kind)
    if not elements:
        return np.zeros(0, layout)
    memory = (ctypes.c_ubyte * (layout.itemsize * len(elements))).from_address(_address(elements[0].pos) + start)
    return np.frombuffer(memory, layout)  # type: ignore[call-overload, no-any-return]


class LightArray:
    """The lights of a scene; see `GeomArray`."""

    def __init__(self, scene: Any, make: Any) -> None:
        self._scene, self._all = scene, _array_of(scene, make, "lights")

    def now(self) -> NDArray[np.void]:
        """(L,) the lights that are used."""
        return self._all[: max(self._scene.nlight, 0)]


class GeomArray:
    """The geoms of a scene, as a structured array that shares the memory of the scene.

    Args:
        scene: `mujoco.MjvScene`.
        make: makes a scene that has room for three geoms.
        model: its materials have the textures of geoms in versions of MuJoCo whose geoms have none.
    """

    def __init__(self, scene: Any, make: Any, model: Any = None) -> None:
        self._scene, self._model = scene, model
        self._all = _array_of(scene, make, "geoms")

    def now(self) -> NDArray[np.void]:
        """(N,) the geoms that are used."""
        used = self._all[: max(self._scene.ngeom, 0)]
        return used if "texid" in (used.dtype.names or ()) else _with_textures(used, self._model)


def _with_textures(used: NDArray[np.void], model: Any) -> NDArray[np.void]:
    """The geoms of a scene of MuJoCo before 3.11, with the textures of their materials."""
    names = used.dtype.names or ()
    fields = [(name, form) for name, form in _FIELDS.items() if name in names or name in _OF_MATERIALS]
    geoms = np.zeros(len(used), fields)
    for name in names:
        geoms[name] = used[name]
    geoms["texid"] = -1
    rows = np.flatnonzero((used["matid"] >= 0) & (used["matid"] < (0 if model is None else model.nmat)))
    if len(rows):
        of = used["matid"][rows]
        geoms["texid"][rows] = textures_of_materials(model)[of]
        geoms["texuniform"][rows], geoms["texrepeat"][rows] = model.mat_texuniform[of], model.mat_texrepeat[of]
    return geoms


def textures_of_materials(model: Any) -> NDArray[np.int32]:
    """(M,) the texture of the colour of each material, -1 for none."""
    if not model.nmat:
        return np.zeros(0, np.int32)
    # before 3.2, materials had one texture
    textures = np.asarray(model.mat_texid, np.int32).reshape(model.nmat, -1)
    return np.ascontiguousarray(textures[:, min(_RGB, textures.shape[1] - 1)])


class Instances(NamedTuple):
    """The instances of shapes that show some geoms.

    Attributes:
        prepared: the shapes.
        geoms: (I,) the geom of each instance.
        scales, offsets: (I, 3) factors of the shape, and its position in the frame of the geom, m.
        shape: (I,) number of the shape, for `first` and `count`.
        rows: (N,) first material of each geom.
        materials, maps: (M,) `MATERIAL` and (M, 4), see `morse.kernel.drawing.arrays.Drawing`.
        parts: (P, 4) of all instances.
        owner: (P,) the instance of each part.
        infinite: numbers of the geoms that are infinite planes.
        endless, free, lines: the instances that are infinite planes, skins and flexes, and lines.
        ids: (I, 2) int32, id and type of the object of each instance; -1 for no object.
        opacity: (N,) of the geoms.
        planes: (N,) which of them are planes.
        casting: (N,) which of them may cast shadows: not lines, which would be as wide as texels.
        scaled: (N,) which of them have no texture, and shapes that are the same for all sizes.
        sizes: (N, 3) of the geoms, m.
        looks: (N, B) all else that the instances depend on.
    """

    prepared: Prepared
    geoms: NDArray[np.intp]
    scales: NDArray[np.float32]
    offsets: NDArray[np.float32]
    rows: NDArray[np.intp]
    materials: NDArray[np.void]
    maps: NDArray[np.float32]
    parts: NDArray[np.int32]
    owner: NDArray[np.intp]
    infinite: NDArray[np.intp]
    endless: NDArray[np.intp]
    free: NDArray[np.intp]
    lines: NDArray[np.intp]
    ids: NDArray[np.int32]
    opacity: NDArray[np.float32]
    planes: NDArray[np.bool_]
    casting: NDArray[np.bool_]
    scaled: NDArray[np.bool_]
    sizes: NDArray[np.float32]
    looks: NDArray[np.uint8]

    def resize(self, g: NDArray[np.void]) -> bool:
        """Take over the sizes of geoms, such as the lengths of tendons; False if other instances are needed."""
        if len(g) != len(self.scaled) or not np.array_equal(_without_sizes(g, self.scaled), self.looks):
            return False
        for number in np.flatnonzero((g["size"] != self.sizes).any(axis=1)):
            parts = _parts_of(g[number], int(number), None, ())
            for row, part in zip(np.flatnonzero(self.geoms == number), parts, strict=True):
                self.scales[row], self.offsets[row] = part.scale, part.offset
        self.sizes[:] = g["size"]
        return True

    def poses(
        self,
        g: NDArray[np.void],
        views: Sequence[View],
        reach: float,
        linewidth: float,
    ) -> Poses:
        """Return the poses of the instances at the present poses of the geoms; infinite planes follow the camera.

        Args:
            g: (N, G) the geoms of N states.
            views: of the N cameras, all orthographic or none: the widths of lines are pixels.
            reach: m, to the border of infinite planes.
            linewidth: factor of the widths of lines.

        Returns:
            Arrays (N I, 12) and (N I, 9): the poses of the first state come first.
        """
        rotation = g["mat"].reshape(*g.shape, 3, 3)[:, self.geoms]
        places = g["pos"][:, self.geoms]
        # the vertices of skins and flexes are those in the world
        if len(self.free):
            rotation[:, self.free], places[:, self.free] = np.eye(3), 0.0
        scales, offsets = self.scales[None], self.offsets
        if len(self.infinite):
            scales = scales.copy()
            for number in self.endless:
                # MuJoCo moves them with the camera, so that their textures stay
                geom, row = g[0, self.geoms[number]], self.rows[self.geoms[number]]
                for axis in range(2):
                    size, repeat = float(geom["size"][axis]), float(geom["texrepeat"][axis])
                    if size <= 0:
                        size = reach
                        # textures begin in the middle
                        self.maps[row, axis], self.maps[row, 2 + axis] = repeat * size / GRID_REACH, 0.5
                    else:
                        whole = repeat * (size if geom["texuniform"] else 1.0)
                        self.maps[row, axis] = whole / GRID_REACH
                        # an edge of the plane is in the middle of a texture
                        self.maps[row, 2 + axis] = 0.5 if _TEXTURES_ARE_CENTRED else 0.5 + whole / 2
                    scales[:, number, axis] = size / GRID_REACH
        if len(self.lines):
            scales = np.repeat(scales, len(g), axis=0)
            of = self.geoms[self.lines]
            eye, forward = (
                np.array([view.eye for view in views], np.float32),
                np.array([view.axes[2] for view in views]),
            )
            middle = g["pos"][:, of] + (rotation[:, self.lines] * offsets[self.lines, None]).sum(axis=-1)
            depth = np.maximum(((middle - eye[:, None]) * forward[:, None]).sum(axis=-1), 1e-3)
            focal = np.array([view.fy for view in views])[:, None]
            half = widths_of(g[:, of], linewidth) * (1.0 if views[0].parallel else depth) / (2 * focal)
            own = scales[:, self.lines]
            # their extents across have no size
            scales[:, self.lines] = np.where(own == 0.0, half[..., None], own)
        models = np.empty((*rotation.shape[:3], 4), np.float32)
        models[..., :3] = rotation * scales[..., None, :]
        models[..., 3] = places + (rotation * offsets[:, None, :]).sum(axis=-1)
        bad = ~(np.abs(models) < 1e7).all(axis=(-1, -2))
        models[bad] = 0.0
        # the inverse transposed, up to a factor
        least = np.maximum(scales.min(axis=-1), 1e-12)[..., None, None]
        turns = rotation / np.maximum(scales, 1e-12)[..., None, :] * least
        turns[bad] = 0.0
        return Poses(models.reshape(-1, 12), np.ascontiguousarray(turns.reshape(-1, 9), np.float32))


def _textures(g: NDArray[np.void], count: int, of_materials: NDArray[np.int32]) -> NDArray[np.int32]:
    """Numbers of the textures of geoms, -1 for none: geoms that programs append may have any number.

    As in MuJoCo, geoms without a material have none, and those without one of their own have that of the material.
    """
    table = np.append(of_materials, np.int32(-1))
    known = (g["matid"] >= 0) & (g["matid"] < len(of_materials))
    texids = np.where(known & (g["texid"] < 0), table[np.where(known, g["matid"], -1)], g["texid"])
    return np.where((g["matid"] >= 0) & (texids >= 0) & (texids < count), texids, np.int32(-1))


def looks_of(g: NDArray[np.void]) -> bytes:
    """All that the instances of geoms depend on."""
    return _looks(g).tobytes()


def _looks(g: NDArray[np.void]) -> NDArray[np.uint8]:
    return g.view(np.uint8).reshape(len(g), g.itemsize).take(_bytes_of_looks(g.dtype), axis=1)


def _without_sizes(g: NDArray[np.void], scaled: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """The same without the sizes of some geoms."""
    looks, first = _looks(g), g.dtype.fields["size"][1]  # type: ignore[index]
    sizes = (_bytes_of_looks(g.dtype) >= first) & (_bytes_of_looks(g.dtype) < first + g.dtype["size"].itemsize)
    looks[np.ix_(scaled, sizes)] = 0
    return looks


@lru_cache(maxsize=1)
def _bytes_of_looks(layout: np.dtype[np.void]) -> NDArray[np.intp]:
    """Where the bytes of `_LOOKS` are in a geom."""
    fields = [layout.fields[name] for name in _LOOKS if name in (layout.fields or ())]  # type: ignore[index]
    return np.concatenate([np.arange(at[1], at[1] + at[0].itemsize) for at in fields])


#: the parts of types of geoms: name of the shape, which of the three sizes scale x, y and z, and the factor of the
#: third size with which the part is shifted along z
_PARTS: dict[int, tuple[tuple[str, tuple[int, int, int], float], ...]] = {
    SPHERE: (("sphere", (0, 1, 2), 0.0),),
    ELLIPSOID: (("sphere", (0, 1, 2), 0.0),),
    CAPSULE: (("tube", (0, 1, 2), 0.0), ("top", (0, 1, 0), 1.0), ("bottom", (0, 1, 0), -1.0)),
    CYLINDER: (("cylinder", (0, 1, 2), 0.0),),
    BOX: (("box", (0, 1, 2), 0.0),),
    TRIANGLE: (("triangle", (0, 1, 2), 0.0),),
}
#: what consists of lines, which are not lit and cast no shadows; pixels of the edges of a box
LINES, _EDGE = (LINE, LINEBOX), 1.5
#: shapes that are not scaled
_WHOLE = (MESH, SDF, HFIELD)


def widths_of(g: NDArray[np.void] | np.void, linewidth: float) -> NDArray[np.float32]:
    """The widths of lines, pixels."""
    widths = np.where(g["type"] == LINE, np.abs(g["size"][..., 0]), np.float32(_EDGE)) * np.float32(linewidth)
    return np.asarray(np.maximum(widths, 1.0), np.float32)


class _Part(NamedTuple):
    key: Key
    geom: int
    scale: tuple[float, float, float]
    offset: tuple[float, float, float]


def _parts_of(geom: np.void, number: int, kind: int | None, faces: Sequence[int]) -> list[_Part]:
    """The parts of a geom; `kind` is that of its texture, and `faces` are the numbers of triangles of flexes."""
    what = int(geom["type"])
    size = tuple(float(part) for part in geom["size"])
    if what in (SKIN, FLEX):
        number_of = int(geom["objid"])
        key = ("skin", number_of) if what == SKIN else ("flex", number_of, faces[number_of])
        return [_Part(key, number, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0))] if what == SKIN or faces[number_of] else []
    one, nowhere = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
    if what in _WHOLE:
        planar = kind == FLAT and not geom["texcoord"]
        inner: Key
        if what == HFIELD:
            inner = ("hfield", int(geom["dataid"]))
        elif geom["dataid"] % 2:
            inner = ("hull", int(geom["dataid"]) // 2)
        else:
            inner = ("mesh", int(geom["dataid"]) // 2, planar)
        return [_Part(_mapped(inner, kind, one, size, bool(geom["texuniform"])), number, one, nowhere)]
    if what in (ARROW, ARROW1, ARROW2, LINE):
        return _connector(what, size, number)
    if what == LINEBOX:
        return _edges_of(size, number)
    if what == PLANE and (size[0] <= 0 or size[1] <= 0):
        return [_Part(("round" if max(size[:2]) <= 0 else "grid",), number, one, nowhere)]
    parts = []
    if what == PLANE:
        return [
            _Part(_mapped(("plane", *_squares(size)), kind, one, one, False), number, (size[0], size[1], 1.0), nowhere)
        ]
    for name, sizes, shift in _PARTS.get(what, ()):
        scale3 = (size[sizes[0]], size[sizes[1]], size[sizes[2]])
        shape: Key = ("planar", (name,)) if kind == FLAT and _TEXTURES_ARE_CENTRED else (name,)
        key = _mapped(shape, kind, scale3, scale3, bool(geom["texuniform"]))
        parts.append(_Part(key, number, scale3, (0.0, 0.0, shift * size[2])))
    return parts


#: number of squares of a plane along a side in MuJoCo, at least (the default of ``numquads``) and at most; and the
#: largest number of those that are drawn here
_FEWEST_ASIDE, _MOST_ASIDE, _MOST_SQUARES = 4, 200, 1024


def _squares(size: Sequence[float]) -> tuple[int, int]:
    """The numbers of squares of a plane along X and Y; 4 of a plane that is lit at each pixel, instead of many."""
    counts = _all_squares(size)
    return counts if counts[0] * counts[1] <= _MOST_SQUARES else (4, 4)


def _all_squares(size: Sequence[float]) -> tuple[int, int]:
    spacing = max(float(size[2]), 1e-9)
    one, other = (int(min(max(math.ceil(2 * float(part) / spacing), _FEWEST_ASIDE), _MOST_ASIDE)) for part in size[:2])
    return one, other


def _mapped(inner: Key, kind: int | None, scale: Sequence[float], size: Sequence[float], uniform: bool) -> Key:
    """The shape, divided at the borders of a cube texture if it has one."""
    if kind not in (CUBE, SKY):
        return inner
    if inner[0] in ("mesh", "hull", "hfield"):
        factors = (1.0, 1.0, 1.0) if uniform else tuple(1.0 / max(part, 1e-9) for part in size)
    else:
        factors = tuple(scale) if uniform else (1.0, 1.0, 1.0)
    most = max(factors)
    return ("cube", inner, tuple(round(part / most, 4) for part in factors))


def _connector(what: int, size: tuple[float, ...], number: int) -> list[_Part]:
    """Arrows and lines, from 0 along Z: the third size is the length of lines, and twice that of arrows."""
    wide, high, length = size
    if what == LINE:
        return [_Part(("cylinder",), number, (0.0, 0.0, length / 2), (0.0, 0.0, length / 2))]
    # a third of an arrow is its head, which is as wide as the shaft without wedges
    head, end = length / 6, length / 3
    wedge = 1.0 if what == ARROW1 else 1.75
    tail = -end if what == ARROW2 else 0.0
    parts = [
        _Part(("cylinder",), number, (wide, high, (end - tail) / 2), (0.0, 0.0, (end + tail) / 2)),
        _Part(("cone",), number, (wedge * wide, wedge * high, head), (0.0, 0.0, end)),
    ]
    if what == ARROW2:
        parts.append(_Part(("cone_down",), number, (wedge * wide, wedge * high, head), (0.0, 0.0, tail)))
    return parts


def _edges_of(size: tuple[float, ...], number: int) -> list[_Part]:
    """The twelve edges of a box, which are lines."""
    return [
        _Part(
            ("box",),
            number,
            (size[0] if along == 0 else 0.0, size[1] if along == 1 else 0.0, size[2] if along == 2 else 0.0),
            (signs[0] * size[0], signs[1] * size[1], signs[2] * size[2]),
        )
        for along in range(3)
        for signs in product(*(((0.0,) if axis == along else (-1.0, 1.0)) for axis in range(3)))
    ]


def instances_of(
    g: NDArray[np.void], store: ModelStore, kinds: NDArray[np.int32], look: Look, faces: Sequence[int]
) -> Instances:
    """Return the instances of geoms.

    Args:
        kinds: (X,) the kind of each texture of the model.
        look: makes the materials.
        faces: numbers of triangles of the flexes.
    """
    texids = _textures(g, len(kinds), look.of_materials)
    parts = [
        part
        for number in range(len(g))
        for part in _parts_of(g[number], number, int(kinds[texids[number]]) if texids[number] >= 0 else None, faces)
    ]
    prepared = store.prepared([part.key for part in parts])
    shapes = [prepared.shapes[part.key] for part in parts]
    geoms = np.array([part.geom for part in parts], np.intp)
    slots = np.ones(len(g), np.intp)
    for part, shape in zip(parts, shapes, strict=True):
        slots[part.geom] = shape.slots
    rows = np.cumsum(slots) - slots
    of_row = np.repeat(np.arange(len(g)), slots)
    materials, maps = look(g, prepared, of_row, np.arange(len(of_row)) - rows[of_row], slots[of_row])
    counts = np.array([shape.size for shape in shapes], np.intp)
    firsts = np.array([shape.first for shape in shapes], np.intp)
    owner = np.repeat(np.arange(len(parts)), counts)
    table = np.zeros((len(owner), 4), np.int32)
    table[:, 0] = firsts[owner] + np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    table[:, 1] = owner
    table[:, 2] = rows[geoms[owner]]
    table[:, 3] = SOLID
    # of surfaces at the same place, the last one is seen
    table, owner = np.ascontiguousarray(table[::-1]), owner[::-1].copy()
    shown = g["segid"][geoms] >= 0
    ids = np.where(shown[:, None], np.stack([g["objid"][geoms], g["objtype"][geoms]], axis=1), -1).astype(np.int32)
    infinite = np.flatnonzero((g["type"] == PLANE) & ((g["size"][:, 0] <= 0) | (g["size"][:, 1] <= 0)))
    return Instances(
        prepared,
        geoms,
        np.array([part.scale for part in parts], np.float32).reshape(-1, 3),
        np.array([part.offset for part in parts], np.float32).reshape(-1, 3),
        rows,
        materials,
        maps,
        table,
        owner,
        infinite,
        np.flatnonzero(np.isin(geoms, infinite)),
        np.flatnonzero(np.isin(g["type"][geoms], (SKIN, FLEX))),
        np.flatnonzero(np.isin(g["type"][geoms], LINES)),
        ids.reshape(-1, 2),
        g["rgba"][:, 3].copy(),
        g["type"] == PLANE,
        (g["castshadow"] != 0 if "castshadow" in (g.dtype.names or ()) else True) & ~np.isin(g["type"], LINES),
        scaled := np.isin(g["type"], list(_PARTS)) & (texids < 0),
        g["size"].copy(),
        _without_sizes(g, scaled),
    )


class Look:
    """Makes the materials of geoms.

    Args:
        plain: whether colours are used without gamma correction, with the lights of OpenGL.
        of_materials: the texture of each material of the model, -1 for none.
    """

    def __init__(self, *, plain: bool, of_materials: NDArray[np.int32]) -> None:
        self._plain, self.of_materials = plain, of_materials

    def __call__(
        self,
        g: NDArray[np.void],
        prepared: Prepared,
        of_row: NDArray[np.intp],
        number: NDArray[np.intp],
        slots: NDArray[np.intp],
    ) -> tuple[NDArray[np.void], NDArray[np.float32]]:
        """Return the materials, (M,) `MATERIAL`, and the maps (M, 4) of texture coordinates.

        Args:
            of_row: (M,) the geom of each material.
            number: (M,) the picture of a cube texture.
            slots: (M,) number of materials of the geom.
        """
        rows = np.zeros(len(of_row), MATERIAL)
        own = g[of_row]
        color = np.nan_to_num(np.clip(own["rgba"][:, :3], 0.0, 1.0), nan=0.0)
        emission = np.clip(np.nan_to_num(own["emission"]), 0.0, 1e3)[:, None] * color
        texids = _textures(own, len(prepared.textures), self.of_materials)
        textured = texids >= 0
        rows["texture"] = np.where(textured, prepared.textures[texids] + number, -1) if len(prepared.textures) else -1
        if self._plain:
            rows["color"][:, :3], rows["emission"] = color, emission
            rows["metallic"], rows["roughness"] = own["specular"], np.clip(own["shininess"], 0.0, 1.0) * 128
        else:
            rows["color"][:, :3], rows["emission"] = linear_light(color), linear_light(emission)
            rows["roughness"] = np.clip(1.0 - 0.8 * own["shininess"], 0.2, 1.0)
        # lines are not lit
        lines = np.isin(own["type"], LINES)
        rows["emission"][lines] = rows["color"][lines, :3]
        rows["color"][lines], rows["metallic"][lines] = 0.0, 0.0
        rows["color"][:, 3] = 1.0
        infinite = (own["type"] == PLANE) & ((own["size"][:, 0] <= 0) | (own["size"][:, 1] <= 0))
        rows["flags"] = HAZED * infinite + DOUBLE_SIDED * np.isin(own["type"], (PLANE, TRIANGLE))
        fine = [
            geom["type"] == PLANE and _squares(geom["size"]) != _all_squares(geom["size"]) if not endless else False
            for geom, endless in zip(own, infinite, strict=True)
        ]
        rows["flags"] |= FINE * np.array(fine, np.int32)
        return rows, self._maps(own, slots)

    def _maps(self, own: NDArray[np.void], slots: NDArray[np.intp]) -> NDArray[np.float32]:
        maps = np.ones((len(own), 4), np.float32)
        maps[:, 2:] = 0.0
        size = np.maximum(own["size"][:, :2], 1e-9)
        uniform = (own["texuniform"] != 0)[:, None]
        repeat = own["texrepeat"]
        planar = np.isin(own["type"], _WHOLE) & (own["texcoord"] == 0)
        # coordinates that are generated are per metre, others per size
        maps[:, :2] = repeat * np.where(
            planar[:, None], np.where(uniform, 1.0, 1.0 / size), np.where(uniform, size, 1.0)
        )
        maps[planar, 2:] = 0.5
        if _TEXTURES_ARE_CENTRED:
            planes = own["type"] == PLANE
            maps[planes, 2:] = 0.5 - maps[planes, :2] / 2
            maps[np.isin(own["type"], list(_PARTS)), 2:] = 0.5
        maps[slots == 6] = 1.0, 1.0, 0.0, 0.0
        return maps
