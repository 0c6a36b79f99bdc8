"""Solids and rays as arrays."""

from __future__ import annotations

import ctypes
import struct
from ctypes import c_double, c_int32, c_int64, c_void_p
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from morse.kernel import threads
from morse.kernel.batched import Lane
from morse.kernel.loading import library
from morse.kernel.memory import address, addresses, aligned, pointer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


__all__ = ["Fan", "GeomPoses", "Hits", "ModelTargets", "Poses", "SolidArrays", "TriangleMesh", "ray_caster"]


#: indices of the kinds of shapes in arrays
BOX, SPHERE, CYLINDER, CAPSULE, ELLIPSOID, MESH, PLANE = range(7)


@dataclass(eq=False)
class TriangleMesh:
    """Triangles in their own frame.

    Attributes:
        vertices: (V, 3) metres.
        faces: (T, 3) indices of vertices.
    """

    vertices: NDArray[np.float64]
    faces: NDArray[np.int32]

    def corners(self) -> NDArray[np.float64]:
        """(T, 3, 3) triangle, corner, axis."""
        return np.ascontiguousarray(self.vertices[self.faces], dtype=np.float64)


class Poses(NamedTuple):
    """The poses of the rigid groups.

    Attributes:
        positions: (K, 3) metres, world frame.
        rotations: (K, 3, 3) from each group to the world.
        anchor: (3,) metres: hits are computed relative to this position.
    """

    positions: NDArray[np.float64]
    rotations: NDArray[np.float64]
    anchor: NDArray[np.float64]


class SolidArrays:
    """Solids, one row each.

    Attributes:
        kinds: (S,) `BOX` to `MESH`.
        sizes: (S, 3) of primitives.
        slots: (S,) the rigid group of each solid.
        places, turns: (S, 3) metres and (S, 3, 3), the pose in the group.
        centres, halves: (S, 3) metres, the box around each, in its own frame.
        meshes: [S] the triangles, None for primitives.
    """

    def __init__(
        self,
        kinds: NDArray[np.integer],
        sizes: NDArray[np.float64],
        slots: NDArray[np.integer],
        places: NDArray[np.float64],
        turns: NDArray[np.float64],
        centres: NDArray[np.float64],
        halves: NDArray[np.float64],
        meshes: Sequence[TriangleMesh | None],
    ) -> None:
        count = len(kinds)
        self.kinds = np.ascontiguousarray(kinds, dtype=np.int32)
        self.sizes = _rows(sizes, (count, 3))
        self.slots = np.ascontiguousarray(slots, dtype=np.int64)
        self.places, self.turns = _rows(places, (count, 3)), _rows(turns, (count, 3, 3))
        self.centres, self.halves = _rows(centres, (count, 3)), _rows(halves, (count, 3))
        self.meshes = list(meshes)
        if len(self.slots) != count or len(self.meshes) != count:
            raise ValueError(f"{count} kinds, but {len(self.slots)} slots and {len(self.meshes)} meshes")

    def __len__(self) -> int:
        return len(self.kinds)


class Fan:
    """The rays of some sensors with the same directions.

    Attributes:
        slots: (B,) the rigid group of each sensor.
        offsets, turns: (B, 3) metres and (B, 3, 3), the pose of each sensor in its group.
        directions: (N, 3) unit vectors in the frame of the sensor.
        origins: (N, 3) metres in the frame of the sensor, None for its origin.
        upright: directions and origins are in the axes of the world.
        limit: maximum distance, metres.
        owners: (B,) the group of solids that the rays of each sensor pass through.
    """

    def __init__(
        self,
        slots: NDArray[np.integer] | Sequence[int],
        offsets: NDArray[np.float64],
        turns: NDArray[np.float64],
        directions: NDArray[np.float64],
        origins: NDArray[np.float64] | None,
        upright: bool,
        limit: float,
        owners: NDArray[np.integer] | Sequence[int],
    ) -> None:
        self.slots = np.ascontiguousarray(slots, dtype=np.int64)
        count, rays = len(self.slots), len(directions)
        self.offsets, self.turns = _rows(offsets, (count, 3)), _rows(turns, (count, 3, 3))
        self.directions = _rows(directions, (rays, 3))
        self.origins = None if origins is None else _rows(origins, (rays, 3))
        self.upright, self.limit = upright, float(limit)
        self.owners = np.ascontiguousarray(owners, dtype=np.int64)
        if len(self.owners) != count:
            raise ValueError(f"{count} sensors, but {len(self.owners)} owners")

    @property
    def shape(self) -> tuple[int, int]:
        """Number of sensors, and of rays of each."""
        return len(self.slots), len(self.directions)


class Hits(NamedTuple):
    """The hits of rays.

    Attributes:
        distances: (B, N) metres, infinite without a hit.
        solids: (B, N) index of the solid, -1 without a hit.
        faces: (B, N) triangle of its mesh, -1 for primitives and without a hit.
    """

    distances: NDArray[np.float64]
    solids: NDArray[np.int64]
    faces: NDArray[np.int32]

    @classmethod
    def empty(cls, shape: tuple[int, int]) -> Hits:
        """Uninitialised hits of some shape."""
        return cls(np.empty(shape), np.empty(shape, dtype=np.int64), np.empty(shape, dtype=np.int32))

    def rows(self, rows: NDArray[np.int64] | slice) -> Hits:
        """The hits of some sensors: views for a slice, else copies."""
        return Hits(self.distances[rows], self.solids[rows], self.faces[rows])

    @classmethod
    def nothing(cls, shape: tuple[int, int]) -> Hits:
        """Rays without a hit."""
        return cls(np.full(shape, np.inf), np.full(shape, -1, dtype=np.int64), np.full(shape, -1, dtype=np.int32))


def _rows(values: NDArray[np.float64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    rows = np.ascontiguousarray(values, dtype=np.float64)
    if rows.shape != shape:
        raise ValueError(f"an array of the shape {shape} is needed, given {rows.shape}")
    return rows


#: bytes of a node of a tree
NODE = np.dtype((np.void, 224))
#: four triangles: corner, axis, triangle
BLOCK = np.dtype({"names": ["corners", "faces"], "formats": [("f8", (3, 3, 4)), ("i4", 4)], "itemsize": 320})


def _addresses(names: str) -> list[tuple[str, type]]:
    return [(name, c_void_p) for name in names.split()]


class MeshStructure(ctypes.Structure):
    """``Mesh``."""

    _fields_ = _addresses("nodes blocks")


class SolidsStructure(ctypes.Structure):
    """``Solids``."""

    _fields_ = _addresses("kinds positions rotations sizes meshes still moving still_leaves moving_leaves")


class PlacingStructure(ctypes.Structure):
    """``Placing``."""

    _fields_ = _addresses(
        "slot_positions slot_rotations anchor slots places turns centres halves kinds positions rotations"
    )


class GatheringStructure(ctypes.Structure):
    """``Gathering``."""

    _fields_ = (("count", c_int32), *_addresses("members boxes scratch nodes leaves"))


class RaysStructure(ctypes.Structure):
    """``Rays``."""

    _fields_ = (
        ("rays", c_int64),
        *_addresses("slot_positions slot_rotations anchor slots offsets turns"),
        ("upright", c_int64),
        *_addresses("directions origins owners groups"),
        ("limit", c_double),
        *_addresses("distances solids faces"),
        ("next", c_int64),
    )


class ModelStructure(ctypes.Structure):
    """``Model`` of ``c/rays_model.c``."""

    _fields_ = (
        ("solids", c_int64),
        *_addresses("kinds geoms bodies sizes centres halves meshes face_normals first_faces"),
    )


class _RoomStructure(ctypes.Structure):
    """``Room`` of ``c/rays_model.c``."""

    _fields_ = _addresses("bundle bounds sorted")


#: ``ModelRays`` of ``c/rays_model.c``; packed at once, which takes a third of the time of a structure of ctypes
_MODEL_RAYS = struct.Struct("2q 4P 3q d q 4P 2q")


#: number of rays that justify another thread
_RAYS_A_THREAD = 2500
#: rays that a thread takes at a time
_PART = 256


class _Memory:
    """Memory to build a tree.

    Args:
        count: number of boxes.
        most: maximum number of boxes in a leaf.
    """

    def __init__(self, count: int, most: int) -> None:
        self.boxes = np.empty((count, 6), dtype=np.float32)
        self.scratch = np.empty(count, dtype=np.int32)
        self.nodes = aligned(max(count - 1, 1), NODE)
        self.leaves = np.empty((count, most), dtype=np.int32)


class _Gathering:
    """Solids in a tree that is rebuilt when they have moved."""

    def __init__(self, members: NDArray[np.integer]) -> None:
        self._members = np.ascontiguousarray(members, dtype=np.int32)
        self._memory = memory = _Memory(len(members), 1)
        rows = (self._members, memory.boxes, memory.scratch, memory.nodes, memory.leaves)
        self.structure = GatheringStructure(len(members), *addresses(*rows))


class _MeshTree:
    """The triangles of a mesh, four at a time, in a tree."""

    def __init__(self, library: ctypes.CDLL, mesh: TriangleMesh) -> None:
        corners = mesh.corners()
        memory, leaf_count = _Memory(len(corners), 4), ctypes.c_int32()
        low, high = corners.min(axis=1, initial=np.inf), corners.max(axis=1, initial=-np.inf)
        memory.boxes[:] = np.concatenate([_below(low), -_below(-high)], axis=1)
        nodes = library.morse_tree_build(
            ctypes.c_int32(len(corners)),
            pointer(memory.boxes),
            ctypes.c_int32(4),
            pointer(memory.scratch),
            pointer(memory.nodes),
            pointer(memory.leaves),
            ctypes.byref(leaf_count),
        )
        leaves = leaf_count.value
        self._nodes, self._blocks = aligned(nodes, NODE), aligned(leaves, BLOCK)
        self._nodes[:] = memory.nodes[:nodes]
        order = memory.leaves[:leaves]
        self._blocks["faces"] = order
        triangles = corners[order] if leaves else np.empty((0, 4, 3, 3))
        triangles[order < 0] = 0.0
        self._blocks["corners"] = triangles.transpose(0, 2, 3, 1)
        self.structure = MeshStructure(address(self._nodes) if nodes else None, address(self._blocks))


def _below(numbers: NDArray[np.float64]) -> NDArray[np.float32]:
    """In single precision, rounded down."""
    limited = np.clip(numbers - 1e-6 * np.abs(numbers) - 1e-9, -3e38, 3e38)
    return limited.astype(np.float32)


class NativeRays:
    """Casts rays at solids."""

    def __init__(self, library: ctypes.CDLL, solids: SolidArrays) -> None:
        self._library = library
        self._keep = solids
        count = len(solids)
        self.positions, self.rotations = np.zeros((count, 3)), np.zeros((count, 3, 3))
        self._gatherings: dict[bool, _Gathering] = {}
        self._fans: WeakKeyDictionary[Fan, tuple[RaysStructure, tuple[object, ...]]] = WeakKeyDictionary()
        self._cast = library.morse_rays_cast
        self._groups: NDArray[np.int64] | None = None
        self._groups_address: int | None = None
        self._known: Poses | None = None
        self._pose_addresses: list[int | None] = []
        self._placing = PlacingStructure(
            None,
            None,
            None,
            *addresses(solids.slots, solids.places, solids.turns, solids.centres, solids.halves, solids.kinds),
            *addresses(self.positions, self.rotations),
        )
        meshes = [None if mesh is None else _tree_of(library, mesh) for mesh in solids.meshes]
        self._meshes = (ctypes.c_void_p * count)(
            *[None if mesh is None else ctypes.addressof(mesh.structure) for mesh in meshes]
        )
        self._mesh_trees = meshes
        self._solids = SolidsStructure(
            *addresses(solids.kinds, self.positions, self.rotations, solids.sizes),
            ctypes.addressof(self._meshes),
        )

    def reshape(self, solid: int, mesh: TriangleMesh, centre: NDArray[np.float64], half: NDArray[np.float64]) -> None:
        """Give a solid other triangles, in the box (3,) and (3,), m; call `place` before rays are cast."""
        tree = self._mesh_trees[solid] = _MeshTree(self._library, mesh)
        self._meshes[solid] = ctypes.addressof(tree.structure)
        self._keep.centres[solid], self._keep.halves[solid] = centre, half

    def gather(self, members: NDArray[np.integer], moving: bool) -> None:
        """Set the fixed or the moving solids; call `place` before rays are cast."""
        self._gatherings[moving] = _Gathering(members)

    def place(self, poses: Poses, moving: bool) -> None:
        """Place the fixed or the moving solids at the poses of their groups."""
        placing, some = self._placing, self._gatherings[moving].structure
        placing.slot_positions, placing.slot_rotations, placing.anchor = self._addresses_of(poses)
        nodes = self._library.morse_rays_place(ctypes.byref(placing), ctypes.byref(some))
        if moving:
            self._solids.moving, self._solids.moving_leaves = some.nodes if nodes else None, some.leaves
        else:
            self._solids.still, self._solids.still_leaves = some.nodes if nodes else None, some.leaves

    def cast(self, fan: Fan, poses: Poses, groups: NDArray[np.int64]) -> Hits:
        """The first hits of the rays; solids of the group (S,) of a sensor's owner are passed through."""
        hits = Hits.empty(fan.shape)
        rays, arguments = self._rays_of(fan)
        rays.slot_positions, rays.slot_rotations, rays.anchor = self._addresses_of(poses)
        if groups is not self._groups:
            self._groups, self._groups_address = groups, address(groups)
        rays.groups = self._groups_address
        rays.distances, rays.solids, rays.faces = addresses(*hits)
        rays.next = 0
        workers = hits.distances.size // _RAYS_A_THREAD
        if workers > 1:
            threads.together(lambda: self._cast(*arguments), workers)
        else:
            self._cast(*arguments)
        return hits

    def lane(self, fan: Fan, poses: Poses, groups: NDArray[np.int64], hits: Hits) -> Lane:
        """Return what `morse.kernel.batched.Lanes` needs to cast a fan; the solids have been placed before.

        Args:
            poses: the arrays that contain the poses at that time.
            hits: the arrays for the results.
        """
        places = addresses(*poses)
        placing = PlacingStructure.from_buffer_copy(self._placing)
        placing.slot_positions, placing.slot_rotations, placing.anchor = places
        rays = RaysStructure.from_buffer_copy(self._rays_of(fan)[0])
        rays.slot_positions, rays.slot_rotations, rays.anchor = places
        rays.groups = address(groups)
        rays.distances, rays.solids, rays.faces = addresses(*hits)
        moving = self._gatherings[True]
        structures = placing, moving.structure, self._solids, rays
        lane = Lane(*map(ctypes.addressof, structures), fan.shape[0] * fan.shape[1])
        lane.keep = self, fan, poses, groups, hits, moving, structures
        return lane

    def _addresses_of(self, poses: Poses) -> list[int | None]:
        """Computed once per moment: obtaining an address takes as long as the rays of a small fan."""
        if self._known is not poses:
            self._known, self._pose_addresses = poses, addresses(*poses)
        return self._pose_addresses

    def _rays_of(self, fan: Fan) -> tuple[RaysStructure, tuple[object, ...]]:
        """What is the same in all casts of a fan: the structure, and the arguments of the function."""
        entry = self._fans.get(fan)
        if entry is None:
            rays = RaysStructure(rays=fan.shape[1], upright=fan.upright, limit=fan.limit)
            whole = fan.shape[0] * fan.shape[1]
            part = _PART if whole // _RAYS_A_THREAD > 1 else max(whole, 1)
            arguments = ctypes.byref(self._solids), ctypes.byref(rays), ctypes.c_int64(whole), ctypes.c_int64(part)
            entry = self._fans[fan] = rays, arguments
            rays.slots, rays.offsets, rays.turns = addresses(fan.slots, fan.offsets, fan.turns)
            rays.directions, rays.origins, rays.owners = addresses(fan.directions, fan.origins, fan.owners)
        return entry


#: bytes of ``Bundle`` of ``c/packets.h``, and of ``Bound`` of ``c/rays_model.c``
_BUNDLE, _BOUND = np.dtype((np.void, 116864)), np.dtype((np.void, 20))
#: number of rays that justify another thread, which takes 0.1 ms of processor time: at models of up to that many
#: primitives, and at others
_FEW_SOLIDS, _RAYS_AT_FEW, _RAYS_AT_MANY = 32, 50_000, 8_000


class _Rooms:
    """Memory of all threads of a call."""

    def __init__(self, solids: int, workers: int) -> None:
        self._memory: list[NDArray[np.generic]] = []
        self.rows = (_RoomStructure * workers)()
        for row in self.rows:
            arrays = aligned(1, _BUNDLE), aligned(solids + 1, _BOUND), aligned(solids + 1, _BOUND)
            row.bundle, row.bounds, row.sorted = addresses(*arrays)
            self._memory += arrays
        self.address = ctypes.addressof(self.rows)
        self.call = ctypes.create_string_buffer(_MODEL_RAYS.size)


class GeomPoses:
    """Where the poses of all geoms of some worlds are in memory, which has to stay as long as this is used.

    Args:
        poses: N times positions (G, 3), m, and rotations (G, 9).
    """

    def __init__(self, poses: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]]) -> None:
        self.count = len(poses)
        self._places = (c_void_p * len(poses))(*[address(row[0]) for row in poses])
        self._turns = (c_void_p * len(poses))(*[address(row[1]) for row in poses])
        self.addresses = ctypes.addressof(self._places), ctypes.addressof(self._turns)


class ModelTargets:
    """The geoms of a model of MuJoCo, of which rays hit some; poses are those of geoms in each world.

    Args:
        library: the kernel.
        kinds: (S,) of solids, `BOX` to `PLANE`.
        geoms: (S,) their geoms, in ascending order; bodies: (S,) the bodies of these.
        sizes, centres, halves: (S, 3) see `SolidArrays`; sizes of planes are half widths, 0 for infinite ones.
        meshes: [S] see `SolidArrays`.
        normals: (F, 3) of the triangles of all meshes; first_faces: (S,) their first ones.
    """

    def __init__(
        self,
        library: ctypes.CDLL,
        kinds: NDArray[np.integer],
        geoms: NDArray[np.integer],
        bodies: NDArray[np.integer],
        sizes: NDArray[np.float64],
        centres: NDArray[np.float64],
        halves: NDArray[np.float64],
        meshes: Sequence[TriangleMesh | None],
        normals: NDArray[np.float64],
        first_faces: NDArray[np.integer],
    ) -> None:
        self._function = library.morse_rays_model
        count = len(kinds)
        trees = [None if mesh is None else _tree_of(library, mesh) for mesh in meshes]
        pointers = (ctypes.c_void_p * count)(
            *[None if tree is None else ctypes.addressof(tree.structure) for tree in trees]
        )
        numbers = [np.ascontiguousarray(values, np.int32) for values in (kinds, geoms, bodies)]
        shapes = [_rows(values, (count, 3)) for values in (sizes, centres, halves)]
        rest = _rows(normals, (len(normals), 3)), np.ascontiguousarray(first_faces, np.int64)
        self._keep = trees, pointers, numbers, shapes, rest
        self._structure = ModelStructure(
            count, *addresses(*numbers, *shapes), ctypes.addressof(pointers), *addresses(*rest)
        )
        self._address = ctypes.byref(self._structure)
        self._rays_a_thread = _RAYS_AT_MANY if count > _FEW_SOLIDS or any(trees) else _RAYS_AT_FEW
        #: memory that no call uses at present, for one thread and for all
        self._rooms: tuple[list[_Rooms], list[_Rooms]] = [], []

    def cast(
        self,
        poses: GeomPoses,
        points: NDArray[np.float64],
        ways: NDArray[np.float64],
        limit: float,
        excluded: int,
        with_normals: bool,
    ) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.float64]]:
        """Return the first hits; several threads may call it at once.

        Args:
            poses: those of N worlds.
            points: (3,), (R, 3) or (N, R, 3), m; contiguous.
            ways: (R, 3) or (N, R, 3), of any length; contiguous.
            limit: largest distance, m.
            excluded: the body through which rays pass; -1 for none.
            with_normals: whether to compute normals.

        Returns:
            (N, R) distances in lengths of the ways, -1 without a hit; (N, R) numbers of geoms, -1 without; (N, R, 3)
            unit normals against the rays, 0 without; (N, 0, 3) if they are not wanted.
        """
        worlds, count = poses.count, ways.shape[-2]
        normals = np.empty((worlds, count if with_normals else 0, 3))
        hits = np.empty((worlds, count)), np.empty((worlds, count), np.int32), normals
        if not worlds or not count:
            return hits
        workers = min(threads.count(), worlds * count // self._rays_a_thread) or 1
        free = self._rooms[workers > 1]
        try:
            rooms = free.pop()
        except IndexError:
            rooms = _Rooms(self._structure.solids, 1 if workers == 1 else threads.count())
        _MODEL_RAYS.pack_into(
            rooms.call,
            0,
            *(worlds, count, *poses.addresses, address(points), address(ways)),
            *(3 * (points.ndim > 1), 3 * count * (points.ndim > 2), 3 * count * (ways.ndim > 2), limit, excluded),
            *(address(hits[0]), address(hits[1]), address(normals) if with_normals else 0, rooms.address, 0, 0),
        )
        if workers == 1:
            self._function(self._address, rooms.call)
        else:
            threads.together(lambda: self._function(self._address, rooms.call), workers)
        free.append(rooms)
        return hits


_trees: WeakKeyDictionary[TriangleMesh, _MeshTree] = WeakKeyDictionary()


def _tree_of(library: ctypes.CDLL, mesh: TriangleMesh) -> _MeshTree:
    if mesh not in _trees:
        _trees[mesh] = _MeshTree(library, mesh)
    return _trees[mesh]


def ray_caster(solids: SolidArrays) -> NativeRays:
    """The function that casts rays."""
    return NativeRays(library(), solids)
