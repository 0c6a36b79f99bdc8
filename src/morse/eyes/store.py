"""The shapes and textures of a model of MuJoCo, prepared once and shared by all renderers of equal models."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any, NamedTuple
from weakref import WeakValueDictionary

import numpy as np

from morse.eyes.shapes import Triangles, cube_mapped, height_field, plane, primitive, surface_mesh
from morse.kernel import threads
from morse.kernel.drawing.arrays import MATERIAL, VERTEX, Drawing
from morse.kernel.drawing.native import NativeDrawer, drawer
from morse.rendering.contents import MeshStore
from morse.rendering.meshes import numbers_as_uvs, numbers_in
from morse.rendering.textures import LINEAR, TextureStore

if TYPE_CHECKING:
    from collections.abc import Collection

    from numpy.typing import NDArray

    from morse.rendering.meshes import Clusters

#: what identifies a shape: its name, and what it depends on
Key = tuple[Any, ...]

#: the arrays of a model from which pictures are prepared
_ARRAYS = tuple(
    """mesh_vert mesh_face mesh_normal mesh_facenormal mesh_texcoord mesh_facetexcoord mesh_vertadr mesh_vertnum
    mesh_faceadr mesh_facenum mesh_normaladr mesh_texcoordadr mesh_graphadr mesh_graph hfield_data hfield_size
    hfield_nrow hfield_ncol skin_face skin_faceadr skin_facenum skin_vertnum tex_data tex_type tex_width tex_height
    tex_colorspace""".split()  # noqa: SIM905
)
#: kinds of textures in MuJoCo
FLAT, CUBE, SKY = range(3)
#: colour space of textures whose codes are sRGB
_SRGB = 2


#: shapes whose vertices are those of a scene
MOVING = ("skin", "flex")


class Shape(NamedTuple):
    """Where a shape is in a `Drawing`.

    Attributes:
        first, size: its clusters.
        slots: number of its materials: 6 for the pictures of a cube texture, else 1.
    """

    first: int
    size: int
    slots: int


class Prepared(NamedTuple):
    """Shapes and textures.

    Attributes:
        shapes: the shapes that there are.
        drawing: their triangles, without instances.
        drawer: a renderer of them, with which others share memory; it draws nothing itself.
        moving: of the shapes whose vertices move, the last ones in the drawing: where their vertices are, and which
            vertex of the skin or corner of the flex each of them is.
        textures: number of the first picture of each texture of the model, -1 for none.
    """

    shapes: dict[Key, Shape]
    drawing: Drawing
    drawer: NativeDrawer
    moving: dict[Key, tuple[slice, NDArray[np.intp]]]
    textures: NDArray[np.int32]


class ModelStore:
    """The shapes and textures of a model; shapes are added when a scene first shows them.

    Args:
        model: the model; its arrays are copied.
        plain: whether the shapes are those of MuJoCo, and textures are used without gamma correction.
    """

    def __init__(self, model: Any, *, plain: bool) -> None:
        self._lock = threads.lock()
        self._plain = plain
        self._arrays = {name: np.array(getattr(model, name)) for name in _ARRAYS if hasattr(model, name)}
        self._quality = _quality(model)
        self._channels = np.array(getattr(model, "tex_nchannel", np.full(model.ntex, 3)))
        self._texture_first = np.array(getattr(model, "tex_adr", ()))
        self._meshes = MeshStore()
        self._chunks: dict[Key, tuple[Clusters, int]] = {}
        self._texture_store = TextureStore()
        self._textures = self._read_textures()
        self._texels = self._texture_store.arrays()
        self._prepared: Prepared | None = None

    def prepared(self, keys: Collection[Key]) -> Prepared:
        """Return shapes, among them those that are asked for."""
        with self._lock:
            missing = [key for key in dict.fromkeys(keys) if key not in self._chunks]
            known = self._prepared is not None and len(self._prepared.shapes) == len(self._chunks)
            if missing or not known:
                made = [self._made(key) for key in missing]  # none if the process was forked meanwhile
                slots = [6 if "cube" in key else 1 for key in missing]
                clusters = self._meshes.clusters(
                    [(mesh, count, mesh.uvs is not None) for mesh, count in zip(made, slots, strict=True)]
                )
                self._chunks.update(zip(missing, zip(clusters, slots, strict=True), strict=True))
                self._prepared = self._joined()
            assert self._prepared is not None
            return self._prepared

    def _joined(self) -> Prepared:
        parts = sorted(self._chunks.items(), key=lambda item: item[0][0] in MOVING)
        chunks = [clusters for _, (clusters, _) in parts]
        shapes, numbers, moving = {}, [], {}
        vertices = triangles = first = 0
        for key, (clusters, slots) in parts:
            if key[0] in MOVING:
                place = slice(vertices, vertices + len(clusters.vertices))
                moving[key] = place, numbers_in(clusters.vertices["uv"])
            shapes[key] = Shape(first, len(clusters.clusters), slots)
            numbers.append(clusters.clusters + np.array([vertices, 0, triangles, 0], np.int32))
            vertices, triangles = vertices + len(clusters.vertices), triangles + len(clusters.triangles)
            first += len(clusters.clusters)
        texels, textures = self._texels
        drawing = Drawing(
            np.concatenate([np.zeros(0, VERTEX), *(c.vertices for c in chunks)]),
            np.concatenate([np.zeros((0, 4), np.int32), *(c.triangles for c in chunks)]),
            np.concatenate([np.zeros((0, 4), np.int32), *numbers]),
            np.concatenate([np.zeros((0, 4), np.float32), *(c.spheres for c in chunks)]),
            np.zeros((0, 4), np.int32),
            np.zeros(0, np.int32),
            np.zeros(0, MATERIAL),
            texels,
            textures,
            np.concatenate([np.zeros(0, np.uint8), *(c.closed for c in chunks)]),
            np.concatenate([np.zeros(0, np.float32), *(c.guards for c in chunks)]),
            np.concatenate([np.zeros((0, 6), np.float32), *(c.levels for c in chunks)]),
        )
        return Prepared(shapes, drawing, drawer(drawing), moving, self._textures)

    # -- shapes ----------------------------------------------------------------------------

    def _made(self, key: Key) -> Triangles:
        name, rest = key[0], key[1:]
        if name == "cube":
            inner, scale = rest
            return cube_mapped(self._made(inner), np.array(scale, np.float64))
        if name == "planar":
            return _planar(self._made(rest[0]))
        if name == "mesh":
            return self._mesh(*rest)
        if name == "hull":
            return self._hull(*rest)
        if name == "hfield":
            return self._height_field(*rest)
        if name == "plane":
            return plane(*rest)
        if name == "skin":
            return self._skin(*rest)
        if name == "flex":
            return _numbered(np.arange(3 * rest[1], dtype=np.int32).reshape(-1, 3), 3 * rest[1])
        return primitive(name, *self._quality)

    def _mesh(self, number: int, planar: bool) -> Triangles:
        a = self._arrays
        first, count = a["mesh_vertadr"][number], a["mesh_vertnum"][number]
        face = slice(a["mesh_faceadr"][number], a["mesh_faceadr"][number] + a["mesh_facenum"][number])
        vertices = a["mesh_vert"].reshape(-1, 3)[first : first + count]
        uvs = uv_index = None
        start = a["mesh_texcoordadr"][number]
        if start >= 0 and not planar:
            uvs, uv_index = a["mesh_texcoord"].reshape(-1, 2)[start:], a["mesh_facetexcoord"].reshape(-1, 3)[face]
        mesh = surface_mesh(
            vertices,
            a["mesh_face"].reshape(-1, 3)[face],
            a["mesh_normal"].reshape(-1, 3)[a["mesh_normaladr"][number] :],
            a["mesh_facenormal"].reshape(-1, 3)[face],
            uvs,
            uv_index,
        )
        return _planar(mesh) if planar else mesh

    def _hull(self, number: int) -> Triangles:
        a = self._arrays
        start = a["mesh_graphadr"][number]
        first, count = a["mesh_vertadr"][number], a["mesh_vertnum"][number]
        vertices = a["mesh_vert"].reshape(-1, 3)[first : first + count]
        if start < 0:
            return self._mesh(number, False)
        graph = a["mesh_graph"][start:]
        corners, faces = int(graph[0]), int(graph[1])
        at = 2 + 2 * corners + corners + 3 * faces
        return surface_mesh(vertices, graph[at : at + 3 * faces].reshape(-1, 3))

    def _height_field(self, number: int) -> Triangles:
        a = self._arrays
        rows, columns = int(a["hfield_nrow"][number]), int(a["hfield_ncol"][number])
        first = int((a["hfield_nrow"][:number] * a["hfield_ncol"][:number]).sum())
        elevation = a["hfield_data"][first : first + rows * columns].reshape(rows, columns)
        return _planar(height_field(elevation, a["hfield_size"][number], flat=self._plain))

    def _skin(self, number: int) -> Triangles:
        a = self._arrays
        first, count = int(a["skin_faceadr"][number]), int(a["skin_facenum"][number])
        return _numbered(a["skin_face"].reshape(-1, 3)[first : first + count], int(a["skin_vertnum"][number]))

    # -- textures --------------------------------------------------------------------------

    def _read_textures(self) -> NDArray[np.int32]:
        a = self._arrays
        spaces = a.get("tex_colorspace", np.zeros(len(a.get("tex_type", ())), np.int32))
        firsts = np.full(len(a.get("tex_type", ())), -1, np.int32)
        for number in range(len(firsts)):
            width, height, channels = int(a["tex_width"][number]), int(a["tex_height"][number]), self._channels[number]
            start = int(self._texture_first[number])
            data = a["tex_data"][start : start + width * height * channels].reshape(height, width, channels)
            pixels = np.full((height, width, 4), 255, np.uint8)
            pixels[..., :3] = data[..., :3] if channels >= 3 else data[..., :1]
            # MuJoCo ignores the colour space of cubes
            decoded = not self._plain or (spaces[number] == _SRGB and a["tex_type"][number] == FLAT)
            light = LINEAR if decoded else np.arange(256) / 255
            if a["tex_type"][number] == FLAT:
                firsts[number] = self._texture_store.add(pixels, light)
                continue
            faces = [pixels[n * width : (n + 1) * width] if height >= 6 * width else pixels for n in range(6)]
            numbers = [self._texture_store.add(face, light) for face in faces]
            firsts[number] = numbers[0]
        return firsts


def _numbered(faces: NDArray[np.int32], vertices: int) -> Triangles:
    """Triangles whose vertices move; see `numbers_as_uvs`."""
    return Triangles(
        np.zeros((vertices, 3), np.float32),
        np.ascontiguousarray(faces, np.int32),
        np.zeros((len(faces), 3, 3), np.float32),
        numbers_as_uvs(faces),
        np.zeros(len(faces), np.int32),
    )


def _planar(mesh: Triangles) -> Triangles:
    """The mesh with the texture coordinates that MuJoCo generates: along X and Y, 1 for 2 units, 0 at the origin."""
    corners = mesh.vertices[mesh.triangles]
    return mesh._replace(uvs=(corners[..., :2] * np.array([0.5, -0.5], np.float32)).astype(np.float32))


def _quality(model: Any) -> tuple[int, int, int]:
    quality = model.vis.quality
    return int(quality.numslices), int(quality.numstacks), int(quality.numquads)


_stores: WeakValueDictionary[tuple[bytes, bool], ModelStore] = WeakValueDictionary()
_stores_lock = threads.lock()


def store_of(model: Any, *, plain: bool) -> ModelStore:
    """Return the shapes and textures of a model; renderers of models with the same share them."""
    digest = hashlib.blake2b(repr(_quality(model)).encode(), digest_size=16)
    for name in _ARRAYS:
        if (values := getattr(model, name, None)) is not None:
            digest.update(f"{name} {values.shape}".encode())
            digest.update(np.ascontiguousarray(values).data if values.size else b"")
    key = digest.digest(), plain
    with _stores_lock:
        store = _stores.get(key)
        if store is None:
            store = _stores[key] = ModelStore(model, plain=plain)
        return store
