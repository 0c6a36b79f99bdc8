"""The visible contents of a world as arrays, and their present poses."""

from __future__ import annotations

import hashlib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from morse.kernel import threads
from morse.kernel.drawing.arrays import (
    DITHERED,
    DOUBLE_SIDED,
    MASKED,
    MATERIAL,
    MIRRORED,
    MOVES,
    SHADELESS,
    SOLID,
    VERTEX,
    Drawing,
)
from morse.mathutils.portable import det, matmul
from morse.rendering.meshes import clusters_of, numbers_as_uvs, numbers_in
from morse.rendering.scenery import Flex, Frames, Scenery
from morse.scene import is_shown, slot_materials
from morse.scene.extent import shown_mesh
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics import World
    from morse.rendering.meshes import Clusters, Triangulated
    from morse.rendering.textures import TextureStore
    from morse.scene import Material, Mesh, Node

#: opacity below which a surface is translucent
_OPAQUE = 0.99


class MeshStore:
    """Cache of meshes divided into clusters, kept across arrangements of a world.

    Args:
        simplified: make levels of detail.
    """

    def __init__(self, *, simplified: bool = False) -> None:
        self._simplified = simplified
        self._known: dict[tuple[int, int, bool], tuple[Triangulated, Clusters]] = {}
        self._alike: dict[tuple[bytes, int, bool], Clusters] = {}

    def clusters(self, requests: Sequence[tuple[Triangulated, int, bool]]) -> list[Clusters]:
        """The clusters of meshes; equal meshes have the same.

        Args:
            requests: meshes, the numbers of their material slots, and whether texture coordinates are used.
        """
        keys = [(id(mesh), slots, textured) for mesh, slots, textured in requests]
        new = {key: request for key, request in zip(keys, requests, strict=True) if key not in self._known}
        alike = {key: (_digest(request[0]), *key[1:]) for key, request in new.items()}
        new_requests = {alike[key]: request for key, request in new.items() if alike[key] not in self._alike}
        with ThreadPoolExecutor(threads.count(), thread_name_prefix="morse-meshes") as pool:
            clusters = pool.map(self._made, new_requests.values())
            self._alike.update(zip(new_requests, clusters, strict=True))
        # keeps the meshes alive, so that their ids are not reused
        self._known.update({key: (new[key][0], self._alike[alike[key]]) for key in new})
        return [self._known[key][1] for key in keys]

    def _made(self, request: tuple[Triangulated, int, bool]) -> Clusters:
        mesh, slots, textured = request
        return clusters_of(mesh, slots, textured=textured, simplified=self._simplified)


def _digest(mesh: Triangulated) -> bytes:
    digest = hashlib.blake2b(digest_size=16)
    for array in (mesh.vertices, mesh.triangles, mesh.material_index, mesh.uvs, mesh.normals):
        values = np.ascontiguousarray(np.zeros(0) if array is None else array)
        digest.update(f"{array is None} {values.dtype} {values.shape}".encode())
        digest.update(values.data)
    return digest.digest()


class Contents:
    """The instances of meshes in a world.

    Attributes:
        scenery: their triangles and surfaces.
        nodes: the node of each instance; the id image contains their indices.
        names: the names of the nodes.
    """

    def __init__(self, world: World, meshes: MeshStore, textures: TextureStore) -> None:
        self._world = world
        self._textures = textures
        self._materials: dict[tuple[object, ...], int] = {}
        self._has_holes: dict[int, bool] = {}
        self._cut: dict[int, list[int]] = {}
        self._chunks: list[Clusters] = []
        self._counts = [0, 0, 0]
        self.nodes = [n for n in world.scene.nodes() if n.mesh is not None and len(n.mesh.triangles)]
        self.names = [node.name for node in self.nodes]
        self._objects = [world.object_of(node) for node in self.nodes]
        self._groups = np.array([obj.slot for obj in self._objects], dtype=np.intp)
        self._shown = np.array([is_shown(node, True) for node in self.nodes], dtype=bool)
        self._stretches, placed = np.zeros((len(self.nodes), 3, 3)), np.zeros((len(self.nodes), 3, 4))
        self._offsets = np.zeros((len(self.nodes), 3, 4))
        surfaces_of = [slot_materials(node, node.mesh) for node in self.nodes if node.mesh is not None]
        textures.read_ahead(m.image for surfaces in surfaces_of for m in surfaces if m.image is not None)
        cuts = meshes.clusters(
            [
                _request(node, mesh, surfaces)
                for node, surfaces in zip(self.nodes, surfaces_of, strict=True)
                if (mesh := shown_mesh(node)) is not None
            ]
        )
        slots: list[int] = []
        parts: list[tuple[int, int, int, int]] = []
        flexed: list[tuple[int, Clusters, int, int]] = []
        for number, (node, surfaces, clusters) in enumerate(zip(self.nodes, surfaces_of, cuts, strict=True)):
            frame = rigid_frame(node)
            self._stretches[number] = [list(row) for row in frame.stretch]
            rotation = np.array([list(row) for row in frame.rotation])
            placed[number, :, :3], placed[number, :, 3] = (
                matmul(rotation, self._stretches[number]),
                frame.position,
            )
            flags = MIRRORED * int(det(self._stretches[number]) < 0.0)
            flags |= MOVES * int(not world.is_fixed(self._groups[number]))
            own = [self._material(material, node.color or material.color) for material in surfaces]
            flags |= SOLID * int(not any(self._has_holes[material] for material in own))
            if node.flex is None:
                parts += [(c, number, len(slots), flags) for c in self._clusters(clusters)]
            else:
                flexed.append((number, clusters, len(slots), flags))
            slots += own
        flexes: list[Flex] = []
        for number, clusters, slot, flags in flexed:
            first, own_first = self._counts[0], self._counts[2]
            # each has its own vertices
            alone = clusters._replace(closed=np.zeros_like(clusters.closed))
            self._cut.pop(id(alone), None)
            own_clusters = self._clusters(alone)
            parts += [(c, number, slot, flags) for c in own_clusters]
            place = slice(first, first + len(clusters.vertices)), slice(own_first, own_first + len(own_clusters))
            flexes.append(self._flex(number, *place, numbers_in(clusters.vertices["uv"])))
        self._settle(range(len(self.nodes)))
        self._layout = -1
        self._displaced: list[int] = []
        texels, textured = textures.arrays()
        table = np.array(list(self._materials) or [(0.0,) * 12], dtype=object)
        drawing = Drawing(
            *self._joined(),
            np.array(parts, np.int32).reshape(-1, 4),
            np.array(slots, np.int32),
            _material_rows(table),
            texels,
            textured,
            np.concatenate([np.zeros(0, np.uint8), *(c.closed for c in self._chunks)]),
            np.concatenate([np.zeros(0, np.float32), *(c.guards for c in self._chunks)]),
            np.concatenate([np.zeros((0, 6), np.float32), *(c.levels for c in self._chunks)]),
        )
        self.scenery = Scenery(drawing, self._groups, placed, flexes)

    # -- contents --------------------------------------------------------------------------

    def _clusters(self, clusters: Clusters) -> list[int]:
        """The indices of the clusters of a mesh in the drawing."""
        if id(clusters) not in self._cut:
            first = self._counts[2]
            self._cut[id(clusters)] = list(range(first, first + len(clusters.clusters)))
            offset = np.array([self._counts[0], 0, self._counts[1], 0], np.int32)
            self._chunks.append(clusters._replace(clusters=clusters.clusters + offset))
            for index, rows in enumerate((clusters.vertices, clusters.triangles, clusters.clusters)):
                self._counts[index] += len(rows)
        return self._cut[id(clusters)]

    def _flex(self, number: int, vertices: slice, clusters: slice, numbers: NDArray[np.intp]) -> Flex:
        """A deformable body; see `Flex`."""
        node = self.nodes[number]
        mesh, follows = shown_mesh(node), node.flex
        assert mesh is not None
        assert follows is not None
        starts = np.array([list(child.location) for child in node.children])
        slots = np.array([self._world.object_of(child).slot for child in node.children], dtype=np.intp)
        uvs = np.zeros((len(mesh.vertices), 2), np.float32)
        if mesh.uvs is not None:
            uvs[mesh.triangles.ravel()] = mesh.uvs.reshape(-1, 2)
        offsets = mesh.vertices.astype(np.float64) - starts[follows]
        return Flex(
            int(self._groups[number]), vertices, clusters, numbers, slots[follows], offsets, mesh.triangles, uvs
        )

    def _joined(self) -> tuple[NDArray[np.void], NDArray[np.int32], NDArray[np.int32], NDArray[np.float32]]:
        return (
            np.concatenate([np.zeros(0, VERTEX), *(c.vertices for c in self._chunks)]),
            np.concatenate([np.zeros((0, 4), np.int32), *(c.triangles for c in self._chunks)]),
            np.concatenate([np.zeros((0, 4), np.int32), *(c.clusters for c in self._chunks)]),
            np.concatenate([np.zeros((0, 4), np.float32), *(c.spheres for c in self._chunks)]),
        )

    def _material(self, material: Material, color: tuple[float, ...]) -> int:
        texture = -1 if material.image is None else self._textures.number(material.image)
        flags = SHADELESS * material.shadeless | DOUBLE_SIDED * material.double_sided
        flags |= DITHERED * (not color[3] >= _OPAQUE)
        flags |= MASKED * (texture >= 0 and self._textures.has_holes(texture))
        row = (*color, *material.emission, material.metallic, material.roughness, texture, int(flags), 0)
        number = self._materials.setdefault(row, len(self._materials))
        self._has_holes[number] = bool(flags & (MASKED | DITHERED))
        return number

    # -- poses -----------------------------------------------------------------------------

    def frames(self, *, moving: bool = False) -> Frames:
        """Return the present poses of the groups; later changes of the world do not affect them.

        Args:
            moving: include the velocities.
        """
        world = self._world
        self._follow()
        positions, rotations = world.slot_poses()
        visible = np.fromiter((obj.visible for obj in self._objects), bool, len(self._objects))
        velocities = self._velocities(len(positions)) if moving else None
        return Frames(positions.copy(), rotations.copy(), self._offsets, self._shown & visible, velocities)

    def _velocities(self, slots: int) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """(K, 3) linear and (K, 3) angular velocities of the slots, world axes; 0 for static slots."""
        velocities = np.zeros((2, slots, 3))
        for slot in np.unique(
            np.concatenate([self._groups, *(flex.followed for flex in self.scenery.flexes)])
        ).tolist():
            if not self._world.is_fixed(slot):
                velocities[:, slot] = self._world.bodies.velocity(slot)
        velocities[~np.isfinite(velocities)] = 0.0
        return velocities[0], velocities[1]

    def _follow(self) -> None:
        """Update the poses of parts that move within their groups."""
        world = self._world
        if self._layout != world.layout:
            self._layout = world.layout
            below = {member for node, frame in world.moving_nodes() if frame == "parent" for member in node.walk()}
            was = self._displaced
            self._displaced = [number for number, node in enumerate(self.nodes) if node in below]
            self._settle(was)
        self._settle(self._displaced)

    def _settle(self, numbers: range | list[int]) -> None:
        if numbers:
            # `Frames` of earlier ticks keep their offsets
            self._offsets = self._offsets.copy()
        for number in numbers:
            position, rotation = self._objects[number].offset
            self._offsets[number, :, :3] = matmul(np.reshape(rotation, (3, 3)), self._stretches[number])
            self._offsets[number, :, 3] = position

    def node(self, number: int) -> Node:
        """The node of an instance."""
        return self.nodes[number]


def _request(node: Node, mesh: Mesh, surfaces: Sequence[Material]) -> tuple[Triangulated, int, bool]:
    """See `MeshStore.clusters`."""
    if node.flex is None:
        return mesh, len(surfaces), any(surface.image is not None for surface in surfaces)
    numbered = replace(
        mesh, uvs=numbers_as_uvs(mesh.triangles), normals=np.zeros((len(mesh.triangles), 3, 3), np.float32)
    )
    return numbered, len(surfaces), True


def _material_rows(table: NDArray[np.object_]) -> NDArray[np.void]:
    rows = np.zeros(len(table), MATERIAL)
    numbers = np.nan_to_num(table[:, :9].astype(np.float64), nan=0.0, posinf=1e6, neginf=0.0)
    rows["color"], rows["emission"] = np.clip(numbers[:, :4], 0.0, 1.0), np.clip(numbers[:, 4:7], 0.0, 1e6)
    rows["metallic"], rows["roughness"] = np.clip(numbers[:, 7:9], 0.0, 1.0).T
    rows["texture"], rows["flags"] = table[:, 9:11].astype(np.int32).T
    return rows
