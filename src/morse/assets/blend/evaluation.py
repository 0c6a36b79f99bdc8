"""Applies the results of Blender to the nodes of a file."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING

import numpy as np

from morse.assets.blend.errors import Damage
from morse.assets.blend.meshes import build
from morse.assets.blend.polygons import gather
from morse.assets.blend.unevaluated import needs
from morse.assets.poses import set_free
from morse.mathutils import Matrix
from morse.scene import NodeKind

if TYPE_CHECKING:
    from pathlib import Path

    from morse.assets.blend.blender import Arrays
    from morse.assets.blend.file import BlendFile
    from morse.assets.blend.objects import Objects
    from morse.scene import Material, Mesh, Node

_MAX_NAMED = 8
_KEYS = ("vertices", "corners", "sizes", "materials", "smooth", "normals", "uvs")


def complete(path: Path, file: BlendFile, objects: Objects, blender: str | None) -> None:
    """Evaluate objects with Blender; without Blender, warn about the objects that are shown as stored."""
    needs_of_objects = {address: need for address in objects.nodes if any(need := needs(objects.records[address]))}
    if not needs_of_objects:
        return
    # imported only for files that need Blender
    from morse.assets.blend.blender import evaluate, find_blender

    nodes = [objects.nodes[address] for address in needs_of_objects]
    program = find_blender(blender)
    if program is None:
        file.warn(
            f"{_listed(nodes)}: modifiers, curves and constraints can only be evaluated by Blender, which was not "
            "found. Apply them in the file, or install Blender (or set MORSE_BLENDER to the path of the program)"
        )
        return
    try:
        arrays = evaluate(path, [node.name for node in nodes], program)
        surfaces = _Surfaces(objects, arrays)
        empty = [
            nodes[number]
            for number, (address, need) in enumerate(needs_of_objects.items())
            if need.mesh and not surfaces.show(address, f"{number}_")
        ]
        if empty:
            file.warn(f"{_listed(empty)}: Blender evaluated no surface; shown as stored in the file")
        posed_numbers = [number for number, need in enumerate(needs_of_objects.values()) if need.pose]
        # parents before their children
        for number in sorted(posed_numbers, key=lambda number: len(list(nodes[number].ancestors()))):
            pose = arrays.get(f"{number}_matrix")
            if pose is not None and pose.shape == (4, 4) and np.isfinite(pose).all():
                _move(nodes[number], Matrix(pose.tolist()))
    except Damage as damage:
        file.warn(
            f"{_listed(nodes)}: modifiers, curves and constraints are ignored, because '{program}' could not "
            f"evaluate them: {damage}"
        )


class _Surfaces:
    """Assigns surfaces that Blender has evaluated to objects; equal surfaces share one mesh."""

    def __init__(self, objects: Objects, arrays: Arrays) -> None:
        self._objects = objects
        self._arrays = arrays
        self._meshes: dict[tuple[object, ...], Mesh] = {}

    def show(self, address: int, prefix: str) -> bool:
        """Set the mesh of an object; False if it has no surface."""
        own = {key: self._arrays[prefix + key] for key in _KEYS if prefix + key in self._arrays}
        if "vertices" not in own:
            return False
        node = self._objects.nodes[address]
        slots = tuple(self._objects.slots(self._objects.records[address]))
        key = (slots, *(hashlib.blake2b(value.tobytes()).digest() for value in own.values()))
        if key not in self._meshes:
            self._meshes[key] = _mesh(node.name, own, slots)
        node.kind, node.mesh, node.materials = NodeKind.MESH, self._meshes[key], []
        return True


def _mesh(name: str, own: Arrays, slots: tuple[Material | None, ...]) -> Mesh:
    if not {"corners", "sizes", "materials", "smooth", "normals"} <= own.keys():
        raise Damage("its result cannot be read")
    counts = own["sizes"].astype(np.int64)
    polygons = gather(
        own["vertices"].astype(np.float64).reshape(-1, 3),
        own["corners"].astype(np.int64),
        np.cumsum(counts) - counts,
        counts,
        materials=own["materials"].astype(np.int64),
        smooth=own["smooth"].astype(np.bool_),
        uvs=own["uvs"].astype(np.float64).reshape(-1, 2) if "uvs" in own else None,
    )
    normals = own["normals"].astype(np.float64).reshape(-1, 3)
    usable = polygons.smooth.any() and len(normals) == len(polygons.corners)
    return build(name, polygons, normals if usable else None, slots)


def _move(node: Node, world: Matrix) -> None:
    """Set the pose of a node to the pose that Blender computed."""
    if node.parent is None:
        set_free(node, world)
        return
    above, basis = (matrix.inverted(None) for matrix in (node.parent.world_matrix(), node.basis_matrix()))
    if above is not None and basis is not None:
        node.parent_inverse = above @ world @ basis


def _listed(nodes: list[Node]) -> str:
    names = ", ".join(f"'{node.name}'" for node in nodes[:_MAX_NAMED])
    more = f" and {len(nodes) - _MAX_NAMED} more" if len(nodes) > _MAX_NAMED else ""
    return f"object{'s' if len(nodes) > 1 else ''} {names}{more}"
