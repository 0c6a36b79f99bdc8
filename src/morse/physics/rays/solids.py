"""What rays can meet: the solids of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.physics.inertia import half_sizes
from morse.physics.layout import Motion
from morse.physics.rays.triangles import Triangles
from morse.scene import Bounds, CollisionShape, Material, PhysicsType, ShapeKind
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from morse.physics.compile import Slot
    from morse.physics.world import World
    from morse.scene import Mesh, Node

_WITHOUT_MATERIAL = Material("default")
#: the order in which arrays number the kinds
KINDS = tuple(ShapeKind)
MESH = KINDS.index(ShapeKind.CONVEX)
BOX = KINDS.index(ShapeKind.BOX)
_KIND_OF_GEOM = {
    int(getattr(mujoco.mjtGeom, f"mjGEOM_{kind.name}")): kind for kind in KINDS if kind is not ShapeKind.CONVEX
}


class Solids:
    """The collision shapes of a world as arrays, one row a solid.

    A solid is a shape of a node; but a mesh that was cut into convex parts for the sake of
    contacts is one solid again, made of its own triangles.

    Attributes:
        geoms: (S,) the MuJoCo geom whose frame is that of the solid.
        slots: (S,) the rigid group that it moves with.
        owners: (S,) the same, with the wheels counted as part of what they hang on.
        nodes: [S] the node that it belongs to.
        kinds: (S,) index into `KINDS`.
        fixed: (S,) whether it stands still, unless someone puts it elsewhere.
        sizes: (S, 3) as MuJoCo gives them; of a mesh the half sizes of its box.
        centres: (S, 3) of the box around it, in its frame.
        halves: (S, 3) half sizes of that box.
        meshes: [S] the triangles of a mesh, in the frame of the solid, or None.
        remissions: (S,) of its first material.
    """

    def __init__(self, world: World) -> None:
        self._known: dict[tuple[object, ...], Triangles] = {}
        rows = [
            (index, node, geom, mesh)
            for index, slot in enumerate(world.slots)
            for node, geoms in slot.geoms.items()
            if node.body.type is not PhysicsType.SENSOR
            for geom, mesh in self._solids_of(world, slot, node, geoms)
        ]
        self.slots = np.array([row[0] for row in rows], dtype=np.intp)
        self.owners = np.array([owner(world, row[0]) for row in rows], dtype=np.intp)
        self.nodes: list[Node] = [row[1] for row in rows]
        self.geoms = np.array([row[2] for row in rows], dtype=np.intp)
        self.meshes: list[Triangles | None] = [row[3] for row in rows]
        self.fixed = np.array([world.slots[row[0]].frame.motion is Motion.FIXED for row in rows], dtype=bool)
        self.remissions = np.array([_remissions(node)[0] for node in self.nodes], dtype=np.float64)
        self.kinds = np.full(len(rows), MESH, dtype=np.int8)
        self.sizes, self.centres, self.halves = (np.zeros((len(rows), 3)) for _ in range(3))
        for i, (_, _, geom, mesh) in enumerate(rows):
            if mesh is not None:
                self.centres[i], self.halves[i] = mesh.box
                self.sizes[i] = self.halves[i]
            else:
                kind = _KIND_OF_GEOM[int(world.model.geom_type[geom])]
                self.kinds[i], self.sizes[i] = KINDS.index(kind), world.model.geom_size[geom]
                self.halves[i] = half_sizes(CollisionShape(kind, tuple(self.sizes[i])))

    def __len__(self) -> int:
        return len(self.nodes)

    def _solids_of(self, world: World, slot: Slot, node: Node, geoms: list[int]) -> list[tuple[int, Triangles | None]]:
        shapes = node.shapes or []
        if slot.frame.motion is Motion.HINGE:
            return [(geom, None) for geom in geoms]
        if _is_cut_up(node):
            assert node.mesh is not None
            return [(geoms[0], self._of_mesh(world, node, node.mesh, geoms[0]))]
        return [
            (geom, self._of_hull(world, node, geom, shape) if shape.kind is ShapeKind.CONVEX else None)
            for geom, shape in zip(geoms, shapes, strict=True)
        ]

    def _of_mesh(self, world: World, node: Node, mesh: Mesh, geom: int) -> Triangles:
        """The triangles of a node's mesh in the frame of one of its geoms."""
        assert node.shapes is not None
        stretch = np.array([list(row) for row in rigid_frame(node).stretch]).round(9)
        remissions = _remissions(node)
        key = (id(mesh), stretch.tobytes(), id(node.shapes[0]), tuple(remissions))
        if key not in self._known:
            position, rotation = world.shape_pose(geom, node.shapes[0])
            vertices = np.asarray(mesh.vertices, dtype=np.float64) @ stretch.T
            vertices = (vertices - position) @ np.reshape(rotation, (3, 3))
            table = np.array(remissions)
            index = np.clip(mesh.material_index, 0, len(table) - 1)
            self._known[key] = Triangles(vertices, np.asarray(mesh.triangles, dtype=np.int32), table[index])
        return self._known[key]

    def _of_hull(self, world: World, node: Node, geom: int, shape: CollisionShape) -> Triangles:
        """The hull that MuJoCo has wrapped around the points of a shape."""
        remission = _remissions(node)[0]
        key = (id(shape), remission)
        if key not in self._known:
            model, mesh = world.model, int(world.model.geom_dataid[geom])
            first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            vertices = model.mesh_vert[first : first + count].astype(np.float64)
            first, count = model.mesh_faceadr[mesh], model.mesh_facenum[mesh]
            faces = model.mesh_face[first : first + count]
            self._known[key] = Triangles(vertices, faces, np.full(len(faces), remission))
        return self._known[key]


def _is_cut_up(node: Node) -> bool:
    """Whether the shapes of a node stand for the triangles of its mesh, and less truly than these."""
    if node.mesh is None or not len(node.mesh.triangles) or node.body.bounds not in (None, Bounds.TRIANGLE_MESH):
        return False
    assert node.shapes is not None
    return any(shape.kind is ShapeKind.CONVEX for shape in node.shapes) or len(set(_remissions(node))) > 1


def _remissions(node: Node) -> list[float]:
    """Of each material slot of a node; at least one."""
    defaults = node.mesh.materials if node.mesh is not None else ()
    count = max(len(node.materials), len(defaults), 1)
    own = [*node.materials, *[None] * (count - len(node.materials))]
    theirs = [*defaults, *[None] * (count - len(defaults))]
    return [float((a or b or _WITHOUT_MATERIAL).specular) for a, b in zip(own, theirs, strict=True)]


def owner(world: World, slot: int) -> int:
    """The slot that a slot is a part of: a wheel belongs to the body that it hangs on."""
    parent = world.slots[slot].frame.parent
    if parent is None:
        return slot
    return next(index for index, other in enumerate(world.slots) if other.frame is parent)
