"""Bodies of people: meshes and collision shapes.

A person is three bodies, the trunk with the head and two legs; somebody in a wheelchair is one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.assets.solids import cube, cylinder, ico_sphere
from morse.plugins.people.gait import HIP
from morse.scene import BodySettings, CollisionShape, Material, Mesh, Node, NodeKind, PhysicsType, ShapeKind

if TYPE_CHECKING:
    from collections.abc import Sequence

#: share of the height of a body up to the shoulders (Drillis and Contini 1966)
_SHOULDER = 0.818
#: m, radius of a leg at a height of 1.72 m
_LEG = 0.07

_SHIRTS = (
    *((0.16, 0.28, 0.48), (0.62, 0.16, 0.14), (0.24, 0.42, 0.28), (0.80, 0.72, 0.55), (0.35, 0.20, 0.40)),
    *((0.85, 0.85, 0.83), (0.20, 0.20, 0.22), (0.78, 0.45, 0.15), (0.30, 0.55, 0.62)),
)
_TROUSERS = ((0.10, 0.12, 0.18), (0.25, 0.22, 0.18), (0.30, 0.34, 0.42), (0.08, 0.08, 0.08))
_SKINS = ((0.87, 0.68, 0.55), (0.62, 0.43, 0.32), (0.36, 0.23, 0.16), (0.93, 0.77, 0.65))
_HAIRS = ((0.12, 0.08, 0.06), (0.35, 0.22, 0.12), (0.55, 0.45, 0.30), (0.5, 0.5, 0.5))
_STEEL = (0.25, 0.25, 0.28)


def _joined(
    name: str, parts: Sequence[tuple[Mesh, tuple[float, float, float], tuple[float, float, float], int]]
) -> Mesh:
    """Return one mesh of meshes with scales, places and numbers of materials."""
    vertices, triangles, materials, normals, count = [], [], [], [], 0
    for mesh, scale, place, material in parts:
        own = mesh.vertices * np.array(scale, dtype=np.float32)
        vertices.append(own + np.array(place, dtype=np.float32))
        triangles.append(mesh.triangles + count)
        materials.append(np.full(len(mesh.triangles), material, dtype=np.int32))
        corners = own[mesh.triangles]
        if mesh.normals is not None:
            turned = mesh.normals / np.array(scale, dtype=np.float32)
        else:
            turned = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, None, :].repeat(
                3, axis=1
            )
        lengths = np.sqrt((turned * turned).sum(axis=2, keepdims=True))
        normals.append((turned / np.maximum(lengths, 1e-12)).astype(np.float32))
        count += len(mesh.vertices)
    return Mesh(
        name,
        np.concatenate(vertices).astype(np.float32),
        np.concatenate(triangles).astype(np.int32),
        np.concatenate(materials),
        normals=np.concatenate(normals),
    )


#: meshes by kind, of a height of 1 m: shared by all people
_MESHES: dict[str, Mesh] = {}


def _mesh(kind: str) -> Mesh:
    if kind not in _MESHES:
        ball, tube, box = ico_sphere(), cylinder(12), cube()
        if kind == "leg":
            # the origin is the sole; the hip is `HIP` above it
            parts = [
                (tube, (0.046, 0.052, 0.5 * HIP - 0.02), (0.0, 0.0, 0.5 * HIP + 0.02), 0),
                (ball, (0.052, 0.056, 0.05), (0.0, 0.0, HIP), 0),
                (box, (0.075, 0.028, 0.018), (0.035, 0.0, 0.018), 1),
            ]
        elif kind == "trunk":
            parts = _upper(ball, tube, 0.0)
        else:
            seat = 0.30
            parts = _upper(ball, tube, seat - HIP)
            parts += [
                (box, (0.16, 0.13, 0.02), (0.02, 0.0, seat - 0.03), 4),
                (box, (0.02, 0.13, 0.16), (-0.14, 0.0, seat + 0.14), 4),
                *((box, (0.15, 0.05, 0.045), (0.12, y, seat), 5) for y in (-0.06, 0.06)),
                *((box, (0.04, 0.045, 0.13), (0.25, y, seat - 0.14), 5) for y in (-0.06, 0.06)),
                *((_wheel(), (0.18, 0.012, 0.18), (-0.06, y, 0.18), 4) for y in (-0.17, 0.17)),
                *((_wheel(), (0.05, 0.01, 0.05), (0.2, y, 0.05), 4) for y in (-0.12, 0.12)),
            ]
        _MESHES[kind] = _joined(f"people {kind}", parts)
    return _MESHES[kind]


def _upper(
    ball: Mesh, tube: Mesh, lower: float
) -> list[tuple[Mesh, tuple[float, float, float], tuple[float, float, float], int]]:
    middle = 0.5 * (HIP + _SHOULDER) + lower
    return [
        (ball, (0.072, 0.105, 0.165), (0.0, 0.0, middle + 0.01), 0),
        (ball, (0.068, 0.095, 0.07), (0.0, 0.0, HIP + 0.02 + lower), 1),
        (ball, (0.055, 0.13, 0.045), (0.0, 0.0, _SHOULDER - 0.03 + lower), 0),
        *((ball, (0.032, 0.03, 0.18), (0.0, y, middle - 0.04), 0) for y in (-0.135, 0.135)),
        *((ball, (0.025, 0.02, 0.035), (0.005, y, middle - 0.22), 2) for y in (-0.14, 0.14)),
        (tube, (0.03, 0.03, 0.03), (0.0, 0.0, 0.84 + lower), 2),
        (ball, (0.056, 0.046, 0.065), (0.01, 0.0, 0.932 + lower), 2),
        (ball, (0.057, 0.049, 0.055), (-0.008, 0.0, 0.948 + lower), 3),
    ]


def _wheel() -> Mesh:
    tube = cylinder(20)
    turned = tube.vertices[:, [0, 2, 1]] * np.array([1.0, -1.0, 1.0], dtype=np.float32)
    return Mesh("wheel", turned.astype(np.float32), tube.triangles, tube.material_index)


def _body(
    name: str, mesh: Mesh, shapes: list[CollisionShape], colors: Sequence[tuple[float, float, float]], height: float
) -> Node:
    node = Node(name, kind=NodeKind.MESH, mesh=mesh, scale=[height] * 3)
    node.materials = [Material(f"{name} {k}", (*color, 1.0)) for k, color in enumerate(colors)]
    # nothing of the engine: rays and images show them, and `contacts` computes what they touch
    node.body = BodySettings(type=PhysicsType.KINEMATIC, ghost=True)
    node.shapes = shapes
    return node


def person(name: str, height: float, look: int, *, rides: bool) -> Node:
    """Return the bodies of a person: the trunk with two legs below it, or one body for somebody in a wheelchair.

    Args:
        name: of the trunk; those of the legs are derived.
        height: m.
        look: number from which the colours follow.
        rides: whether the person sits in a wheelchair.
    """
    shirt, trousers = _SHIRTS[look % len(_SHIRTS)], _TROUSERS[look // 3 % len(_TROUSERS)]
    skin, hair = _SKINS[look // 2 % len(_SKINS)], _HAIRS[look // 5 % len(_HAIRS)]
    head = CollisionShape(ShapeKind.SPHERE, (0.06 * height,), (0.0, 0.0, 0.935 * height))
    trunk = CollisionShape(
        ShapeKind.ELLIPSOID, (0.075 * height, 0.15 * height, 0.19 * height), (0.0, 0.0, 0.68 * height)
    )
    if rides:
        lower = (0.30 - HIP) * height
        shapes = [
            CollisionShape(shape.kind, shape.size, (0.0, 0.0, shape.position[2] + lower)) for shape in (trunk, head)
        ]
        shapes.append(
            CollisionShape(ShapeKind.BOX, (0.24 * height, 0.18 * height, 0.16 * height), (0.02, 0.0, 0.18 * height))
        )
        return _thing(_body(name, _mesh("chair"), shapes, (shirt, trousers, skin, hair, _STEEL, trousers), height))
    top = _thing(_body(name, _mesh("trunk"), [trunk, head], (shirt, trousers, skin, hair), height))
    half = 0.5 * HIP * height
    for side in ("left", "right"):
        shapes = [CollisionShape(ShapeKind.CYLINDER, (_LEG * height / 1.72, half), (0.0, 0.0, half))]
        # the scale of the trunk holds for the legs, too
        top.attach(_body(f"{name} {side} leg", _mesh("leg"), shapes, (trousers, (0.08, 0.07, 0.06)), 1.0))
    return top


def _thing(node: Node) -> Node:
    """Let cameras that recognize objects tell the person from others."""
    node.properties.update(Object=True, Type="person", Label=node.name)
    return node
