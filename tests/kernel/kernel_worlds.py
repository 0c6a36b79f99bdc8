"""Random solids and rays, as arrays."""

from dataclasses import dataclass

import numpy as np

from morse.kernel.rays import CAPSULE, CYLINDER, MESH, SPHERE, Fan, Poses, SolidArrays, TriangleMesh

KINDS = range(6)


def rotations(rng, count):
    """(count, 3, 3) proper rotations."""
    turned = np.linalg.qr(rng.normal(size=(count, 3, 3)))[0] if count else np.empty((0, 3, 3))
    return turned * np.sign(np.linalg.det(turned))[:, None, None] if count else turned


def half_sizes(kind, size):
    """Half extents of the bounding box of a primitive."""
    if kind == SPHERE:
        return [size[0]] * 3
    if kind == CYLINDER:
        return [size[0], size[0], size[1]]
    if kind == CAPSULE:
        return [size[0], size[0], size[1] + size[0]]
    return list(size)


def soup(rng, triangles):
    """Triangles with shared corners."""
    vertices = rng.normal(size=(max(triangles, 3), 3))
    return TriangleMesh(vertices, rng.integers(0, len(vertices), (triangles, 3)).astype(np.int32))


@dataclass
class RandomWorld:
    solids: SolidArrays
    poses: Poses
    groups: np.ndarray
    moving: np.ndarray
    rng: np.random.Generator

    def fan(self, sensors=4, rays=30, limit=1e30, origins=False, upright=False):
        rng = self.rng
        directions = rng.normal(size=(rays, 3))
        directions /= np.linalg.norm(directions, axis=1)[:, None]
        directions[: min(rays, 6)] = np.concatenate([np.eye(3), -np.eye(3)])[:rays]  # along the axes
        return Fan(
            rng.integers(0, len(self.poses.positions), sensors),
            rng.normal(size=(sensors, 3)),
            rotations(rng, sensors),
            directions,
            rng.normal(size=(rays, 3)) if origins else None,
            upright,
            limit,
            rng.integers(0, 4, sensors),
        )

    def cast(self, caster, fan):
        caster.gather(np.flatnonzero(~self.moving), moving=False)
        caster.gather(np.flatnonzero(self.moving), moving=True)
        caster.place(self.poses, moving=False)
        caster.place(self.poses, moving=True)
        return caster.cast(fan, self.poses, self.groups)


def random_world(seed, count=20, slots=5, away=0.0, spread=2.5, largest=200):
    rng = np.random.default_rng(seed)
    kinds = rng.integers(0, len(KINDS), count)
    sizes = rng.uniform(0.1, 2.0, (count, 3))
    meshes = [soup(rng, int(rng.integers(0, largest))) if kind == MESH else None for kind in kinds]
    boxes = [mesh and (mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)) for mesh in meshes]
    centres = np.array([np.zeros(3) if box is None else (box[0] + box[1]) / 2 for box in boxes]).reshape(count, 3)
    halves = [
        half_sizes(kind, size) if box is None else (box[1] - box[0]) / 2
        for kind, size, box in zip(kinds, sizes, boxes, strict=True)
    ]
    solids = SolidArrays(
        kinds,
        sizes,
        rng.integers(0, slots, count),
        rng.normal(size=(count, 3)) * spread,
        rotations(rng, count),
        centres,
        np.array(halves).reshape(count, 3),
        meshes,
    )
    poses = Poses(rng.normal(size=(slots, 3)) * spread + away, rotations(rng, slots), np.full(3, np.round(away)))
    return RandomWorld(solids, poses, rng.integers(0, 4, count), rng.random(count) < 0.5, rng)
