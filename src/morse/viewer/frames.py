"""The rigid frames of many nodes at once: `morse.scene.frames` in arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.scene import Node

    Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class RigidFrames:
    """The frames of N nodes.

    Attributes:
        positions: (N, 3) metres, in the rigid frame of the parent.
        quaternions: (N, 4) w, x, y, z, from the rigid frame of the node to that of the parent.
        stretches: (N, 3, 3) scale, shear and mirroring of the meshes; exactly the identity if there is none.
    """

    positions: Floats
    quaternions: Floats
    stretches: Floats


def rigid_frames(nodes: Sequence[Node]) -> RigidFrames:
    """The rigid frames of nodes. The list must contain all parents, before their children."""
    index = {id(node): i for i, node in enumerate(nodes)}
    parents = np.array([-1 if node.parent is None else index[id(node.parent)] for node in nodes], dtype=int)
    world = _world_matrices(nodes, parents)
    rotations = _orthonormal(world[:, :3, :3])
    stretches = rotations.transpose(0, 2, 1) @ world[:, :3, :3]
    plain = np.abs(stretches - np.eye(3)).max(axis=(1, 2), initial=0.0) < 1e-9
    stretches[plain] = np.eye(3)
    # relative to the parent; to the world for nodes without a parent
    base = np.where((parents < 0)[:, None, None], np.eye(3), rotations[parents]).transpose(0, 2, 1)
    origins = np.where((parents < 0)[:, None], 0.0, world[parents, :3, 3])
    positions = np.einsum("nij,nj->ni", base, world[:, :3, 3] - origins)
    return RigidFrames(positions, _quaternions(base @ rotations), stretches)


def _world_matrices(nodes: Sequence[Node], parents: NDArray[np.int_]) -> Floats:
    local = _basis_matrices(nodes)
    for i, node in enumerate(nodes):
        if node.parent_inverse is not None:
            local[i] = np.array([list(row) for row in node.parent_inverse]) @ local[i]
    depths = np.zeros(len(nodes), dtype=int)
    for i, parent in enumerate(parents):
        depths[i] = depths[parent] + 1 if parent >= 0 else 0
    for depth in range(1, int(depths.max(initial=0)) + 1):
        rows = np.flatnonzero(depths == depth)
        local[rows] = local[parents[rows]] @ local[rows]
    return local


def _basis_matrices(nodes: Sequence[Node]) -> Floats:
    """(N, 4, 4) from location, rotation (``Rz @ Ry @ Rx``) and scale only."""
    angles = np.array([list(node.rotation_euler) for node in nodes], dtype=float).reshape(-1, 3)
    (cx, cy, cz), (sx, sy, sz) = np.cos(angles).T, np.sin(angles).T
    rows = [
        [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
        [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
        [-sy, cy * sx, cy * cx],
    ]
    scales = np.array([list(node.scale) for node in nodes], dtype=float).reshape(-1, 3)
    matrices = np.zeros((len(nodes), 4, 4))
    matrices[:, :3, :3] = np.array(rows).transpose(2, 0, 1) * scales[:, None, :]
    matrices[:, :3, 3] = np.array([list(node.location) for node in nodes], dtype=float).reshape(-1, 3)
    matrices[:, 3, 3] = 1.0
    return matrices


def _orthonormal(matrices: Floats) -> Floats:
    """Proper rotations: X along the first column, Y in the plane of the first two columns."""
    x = _unit(matrices[:, :, 0], np.array([1.0, 0.0, 0.0]))
    along = matrices[:, :, 1]
    spare = np.where(np.abs(x[:, 1:2]) < 0.9, np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
    y = _unit(along - x * _dot(along, x), spare)
    y = _unit(y - x * _dot(y, x), y)
    return np.stack([x, y, np.cross(x, y)], axis=2)


def _dot(a: Floats, b: Floats) -> Floats:
    products: Floats = np.einsum("ni,ni->n", a, b)
    return products[:, None]


def _unit(vectors: Floats, fallback: Floats) -> Floats:
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 1e-12, vectors / np.where(lengths > 1e-12, lengths, 1.0), fallback)


def _quaternions(rotations: Floats) -> Floats:
    """(N, 4) w, x, y, z of rotation matrices, from the largest component (Shepperd, 1978)."""
    diagonal = np.diagonal(rotations, axis1=1, axis2=2)
    squares = np.concatenate(
        [diagonal.sum(axis=1, keepdims=True), 2 * diagonal - diagonal.sum(axis=1, keepdims=True)], 1
    )
    # outer product of the quaternion with itself, times four
    products = np.zeros((len(rotations), 4, 4))
    products[:, range(4), range(4)] = 1.0 + squares
    r = rotations
    pairs = {
        (0, 1): r[:, 2, 1] - r[:, 1, 2],
        (0, 2): r[:, 0, 2] - r[:, 2, 0],
        (0, 3): r[:, 1, 0] - r[:, 0, 1],
        (1, 2): r[:, 1, 0] + r[:, 0, 1],
        (1, 3): r[:, 0, 2] + r[:, 2, 0],
        (2, 3): r[:, 2, 1] + r[:, 1, 2],
    }
    for (i, j), value in pairs.items():
        products[:, i, j] = products[:, j, i] = value
    rows: Floats = products[np.arange(len(r)), squares.argmax(axis=1)]
    rows /= np.linalg.norm(rows, axis=1, keepdims=True)
    return np.where(rows[:, :1] < 0.0, -rows, rows)
