"""The solids of a world, which rays can hit."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.kernel import rays as kinds
from morse.kernel.rays import TriangleMesh
from morse.mathutils.portable import matmul
from morse.physics.model.layout import Motion
from morse.physics.model.shapes import half_sizes
from morse.physics.poses import rigid
from morse.physics.poses.rigid import as_array
from morse.scene import Bounds, CollisionShape, Material, PhysicsType, ShapeKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from morse.physics.objects.gameobject import GameObject
    from morse.physics.objects.object_world import ObjectWorld
    from morse.scene import Mesh, Node

    Hull = tuple[NDArray[np.float64], NDArray[np.int32]]

#: hulls by the bytes of their points: most scenes are loaded several times in a process
_hulls: dict[bytes, Hull] = {}
_MOST = 1000


def hulls_of(shapes: Sequence[CollisionShape]) -> dict[CollisionShape, Hull]:
    """Return vertices (V, 3) in the frame of the node and faces (T, 3) of convex shapes; the arrays are shared.

    MuJoCo computes the hulls, as for contacts, so that rays and contacts use the same geometry.
    """
    keys = {shape: np.ascontiguousarray(shape.vertices, dtype=np.float32).tobytes() for shape in shapes}
    here = {key: _hulls[key] for key in keys.values() if key in _hulls}
    if missing := list(dict.fromkeys(key for key in keys.values() if key not in here)):
        here.update(zip(missing, _computed(missing), strict=True))
        if len(_hulls) > _MOST:
            _hulls.clear()
        _hulls.update(here)
    return {shape: here[key] for shape, key in keys.items()}


def _computed(points: Sequence[bytes]) -> list[Hull]:
    spec = mujoco.MjSpec()
    for number, rows in enumerate(points):
        spec.add_mesh(
            name=str(number),
            uservert=np.frombuffer(rows, dtype=np.float32),
            inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_CONVEX,
        )
    model = spec.compile()
    hulls = []
    for number in range(len(points)):
        mesh = model.mesh(str(number)).id
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        # the compiler has moved the mesh to its centre of mass and principal axes
        rotation = np.reshape(rigid.rotation_of_quaternion(model.mesh_quat[mesh]), (3, 3))
        vertices = matmul(model.mesh_vert[first : first + count].astype(np.float64), rotation.T) + model.mesh_pos[mesh]
        first, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
        faces = model.mesh_face[first : first + count].astype(np.int32)
        vertices.flags.writeable = faces.flags.writeable = False
        hulls.append((vertices, faces))
    return hulls


class Triangles(TriangleMesh):
    """A triangle mesh with its own frame.

    Attributes:
        vertices: (V, 3) m.
        faces: (T, 3) indices of vertices; degenerate triangles are excluded.
        normals: (T, 3) unit vectors.
        remissions: (T,) reflectance of each triangle, 0..1.
    """

    def __init__(
        self, vertices: NDArray[np.float64], faces: NDArray[np.int32], remissions: NDArray[np.float64]
    ) -> None:
        corners = vertices[faces]
        crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(crosses, axis=1)
        good = np.isfinite(lengths) & (lengths > 0.0)
        super().__init__(vertices, np.ascontiguousarray(faces[good], dtype=np.int32))
        self.remissions = remissions[good]
        self.normals = crosses[good] / lengths[good, None]

    @property
    def box(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the centre (3,) and half sizes (3,) of the bounding box, m."""
        corners = self.vertices[self.faces].reshape(-1, 3)
        if not len(corners):
            return np.zeros(3), np.zeros(3)
        low, high = corners.min(axis=0), corners.max(axis=0)
        return (low + high) / 2, (high - low) / 2


#: farther coordinates, m, are those of a body that has diverged
_FARTHEST = 1e6


class SoftTriangles(Triangles):
    """The triangles of a deformable body, with the axes of the world; their origin is the mean of its vertices.

    Attributes:
        followed: (V,) the slot that each vertex follows.
    """

    def __init__(self, world: ObjectWorld, node: Node) -> None:
        mesh, follows = node.mesh, node.flex
        assert mesh is not None
        assert follows is not None
        starts = np.array([list(child.location) for child in node.children], dtype=np.float64)
        slots = np.array([world.object_of(child).slot for child in node.children], dtype=np.intp)
        remissions = _remissions(node)
        index = np.clip(mesh.material_index, 0, len(remissions) - 1)
        super().__init__(np.asarray(mesh.vertices, np.float64), mesh.triangles, np.array(remissions)[index])
        self._origin = world.object_of(node).slot
        self._offsets = self.vertices - starts[follows]
        self.followed = slots[follows]

    def bent(self, positions: NDArray[np.float64]) -> SoftTriangles:
        """Return the triangles at the present positions (K, 3) of the slots, m; they have the same numbers."""
        other = copy.copy(self)
        points = positions[self.followed] + self._offsets - positions[self._origin]
        other.vertices = np.where(np.abs(points) < _FARTHEST, points, 0.0)
        corners = other.vertices[self.faces]
        crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        other.normals = crosses / np.maximum(np.linalg.norm(crosses, axis=1), 1e-300)[:, None]
        return other

    def corners_of(self, face: int) -> list[int]:
        """Return the slots (3) that the corners of a triangle follow."""
        slots: list[int] = self.followed[self.faces[face]].tolist()
        return slots


_WITHOUT_MATERIAL = Material("default")
#: kinds of solids; arrays contain the index
KINDS = {
    ShapeKind.BOX: kinds.BOX,
    ShapeKind.SPHERE: kinds.SPHERE,
    ShapeKind.CYLINDER: kinds.CYLINDER,
    ShapeKind.CAPSULE: kinds.CAPSULE,
    ShapeKind.ELLIPSOID: kinds.ELLIPSOID,
    ShapeKind.CONVEX: kinds.MESH,
}


class Solids:
    """The collision shapes of a world as arrays, one row per solid.

    A solid is a shape of a node, with its own frame. A mesh that was divided into convex parts for contacts is one
    solid, which consists of the original triangles in the frame of the node. So is a deformable body, without shapes.

    Attributes:
        slots: (S,) rigid group of each solid.
        owners: (S,) rigid group of each solid, with wheels assigned to the body to which they are attached.
        fixed: (S,) whether the solid is static.
        nodes: [S] node of each solid.
        kinds: (S,) index into `KINDS`.
        sizes: (S, 3) size of a primitive, see `CollisionShape`.
        centres: (S, 3) centre of the bounding box in the frame of the solid, m.
        halves: (S, 3) half sizes of the bounding box, m.
        meshes: [S] the triangles of a mesh, or None.
        places: (S, 3) position in the frame of the group, m.
        turns: (S, 3, 3) rotation from the solid to the group.
    """

    def __init__(self, world: ObjectWorld) -> None:
        self._world = world
        rows = list(_rows(world))
        count = len(rows)
        self.nodes: list[Node] = [row[0] for row in rows]
        self._shapes = [row[1] for row in rows]
        self.meshes: list[Triangles | None] = [row[2] for row in rows]
        slots = [world.object_of(node).slot for node in self.nodes]
        self.slots = np.array(slots, dtype=np.int64)
        self.owners = np.array([owner(world, slot) for slot in slots], dtype=np.int64)
        self.fixed = np.array([world.slots[slot].frame.motion is Motion.FIXED for slot in slots], dtype=bool)
        # concatenated for all triangles; other solids have one number
        parts = [np.array(_remissions(node)[:1]) if mesh is None else mesh.remissions for node, _, mesh in rows]
        self._remissions = np.concatenate([*parts, np.zeros(1)])
        self._first_remissions = np.cumsum([0, *(len(part) for part in parts)])
        self.kinds = np.full(count, kinds.MESH, dtype=np.int32)
        self.sizes, self.centres, self.halves = np.ones((count, 3)), np.zeros((count, 3)), np.zeros((count, 3))
        for index, (_, shape, mesh) in enumerate(rows):
            if shape is not None:
                self.kinds[index] = KINDS[shape.kind]
                self.sizes[index, : len(shape.size)] = shape.size
                self.halves[index] = half_sizes(shape)
            elif mesh is not None:
                self.centres[index], self.halves[index] = mesh.box
        self.places, self.turns = np.zeros((count, 3)), np.zeros((count, 3, 3))
        #: numbers of the deformable bodies
        self.soft = [number for number, mesh in enumerate(self.meshes) if isinstance(mesh, SoftTriangles)]
        self.settle(range(count))

    def __len__(self) -> int:
        return len(self.nodes)

    def owner_of(self, slot: int) -> int:
        """Return the group of a slot, see ``owners``."""
        return owner(self._world, slot)

    def bend(self, number: int) -> SoftTriangles:
        """Move the triangles of a deformable body to the present positions of its vertices."""
        mesh = self.meshes[number]
        assert isinstance(mesh, SoftTriangles)
        mesh = self.meshes[number] = mesh.bent(self._world.slot_poses()[0])
        self.centres[number], self.halves[number] = mesh.box
        return mesh

    def settle(self, members: range | list[int]) -> None:
        """Update the poses of some solids in their groups."""
        for index in members:
            shape = self._shapes[index]
            position, rotation = self._world.object_of(self.nodes[index]).offset
            if shape is not None:
                position, rotation = rigid.compose(position, rotation, shape.position, shape.rotation)
            self.places[index] = position
            self.turns[index] = np.reshape(rotation, (3, 3))

    def remissions_of(self, solids: NDArray[np.int64], faces: NDArray[np.int32]) -> NDArray[np.float64]:
        """Return (N,) ``specular`` of the materials of the solids and triangles that were hit; 0 for no hit."""
        rows = self._first_remissions[solids] + np.maximum(faces, 0)
        return np.where(solids >= 0, self._remissions[rows], 0.0)


def _rows(world: ObjectWorld) -> Iterator[tuple[Node, CollisionShape | None, Triangles | None]]:
    """Iterate over the solids: a node with a primitive shape or with triangles; deformable bodies are the last ones."""
    cache: dict[tuple[object, ...], Triangles] = {}
    nodes = [node for slot in world.slots for node in slot.frame.solid if node.body.type is not PhysicsType.SENSOR]
    whole = [node for node in nodes if not _is_cut_up(node)]
    hulls = hulls_of([s for node in whole for s in node.shapes or () if s.kind is ShapeKind.CONVEX])
    for node in nodes:
        if _is_cut_up(node):
            assert node.mesh is not None
            yield node, None, _of_mesh(node, node.mesh, cache)
            continue
        for shape in node.shapes or ():
            if shape.kind is not ShapeKind.CONVEX:
                yield node, shape, None
                continue
            remission = _remissions(node)[0]
            if (id(shape), remission) not in cache:
                vertices, faces = hulls[shape]
                cache[id(shape), remission] = Triangles(vertices, faces, np.full(len(faces), remission))
            yield node, None, cache[id(shape), remission]
    for slot in world.slots:
        if slot.frame.node.flex is not None:
            yield slot.frame.node, None, SoftTriangles(world, slot.frame.node)


#: collision shapes that approximate the mesh
_LIKE_MESH = (None, Bounds.TRIANGLE_MESH, Bounds.DECOMPOSITION)


def _is_cut_up(node: Node) -> bool:
    """Whether the shapes of a node approximate its mesh, so that its triangles are used instead."""
    if node.mesh is None or not len(node.mesh.triangles) or node.body.bounds not in _LIKE_MESH:
        return False
    assert node.shapes is not None
    return (
        any(shape.kind in (ShapeKind.CONVEX, ShapeKind.HEIGHT_FIELD) for shape in node.shapes)
        or len(set(_remissions(node))) > 1
    )


def _of_mesh(node: Node, mesh: Mesh, cache: dict[tuple[object, ...], Triangles]) -> Triangles:
    """Return the triangles of the mesh of a node in the rigid frame of the node."""
    stretch = as_array(rigid_frame(node).stretch).round(9)
    remissions = _remissions(node)
    key = (id(mesh), stretch.tobytes(), tuple(remissions))
    if key not in cache:
        index = np.clip(mesh.material_index, 0, len(remissions) - 1)
        vertices = matmul(np.asarray(mesh.vertices, dtype=np.float64), stretch.T)
        cache[key] = Triangles(vertices, np.asarray(mesh.triangles, dtype=np.int32), np.array(remissions)[index])
    return cache[key]


def _remissions(node: Node) -> list[float]:
    """Return the remission of each material slot of a node; at least one."""
    defaults = node.mesh.materials if node.mesh is not None else ()
    count = max(len(node.materials), len(defaults), 1)
    own = [*node.materials, *[None] * (count - len(node.materials))]
    theirs = [*defaults, *[None] * (count - len(defaults))]
    return [float((a or b or _WITHOUT_MATERIAL).specular) for a, b in zip(own, theirs, strict=True)]


def owner(world: ObjectWorld, slot: int) -> int:
    """Return the slot to which a slot belongs: wheels and links belong to the body to which they are attached."""
    parent = world.slots[slot].frame.parent
    while parent is not None:
        slot = world.slot_of[parent.node]
        parent = parent.parent
    return slot


def body_of(world: ObjectWorld, part: GameObject) -> GameObject:
    """Return the body of a part: hits on the shapes of a compound are reported as hits on the compound."""
    if not part.is_dynamic:
        return part
    body = world.object_of(world.slots[owner(world, part.slot)].frame.node)
    return body if body.node.body.compound else part
