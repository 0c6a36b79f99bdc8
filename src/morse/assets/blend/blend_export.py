"""Runs inside Blender: evaluates meshes and poses of some objects and writes them as arrays.

``blender -b --python blend_export.py -- source.blend result.npz names.json``. It imports nothing but Blender's own
module, numpy and the standard library, and runs in a process of its own.
"""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

import bpy  # type: ignore[import-not-found]
import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable

#: maximum number of polygons of a subdivided mesh
MAX_POLYGONS = 100_000


def main(source: str, result: str, names: str) -> None:
    """Open a file and write the requested arrays.

    For each object number `i` in the list of names: ``i_matrix`` (4, 4) its pose in the world, and if it has a
    surface ``i_vertices`` (V, 3), ``i_corners`` (C,), ``i_sizes`` (P,), ``i_materials`` (P,), ``i_smooth`` (P,),
    ``i_normals`` (C, 3) and optionally ``i_uvs`` (C, 2).
    """
    bpy.ops.wm.open_mainfile(filepath=source, load_ui=False, use_scripts=False)
    with open(names, encoding="utf-8") as file:
        wanted = json.load(file)
    objects = {obj.name: obj for obj in bpy.data.objects if obj.library is None}
    reveal(objects.values())
    for name in wanted:
        if name in objects:
            limit_subdivision(objects[name])
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    arrays: dict[str, Any] = {}
    for number, name in enumerate(wanted):
        if name in objects:
            evaluated = objects[name].evaluated_get(depsgraph)
            arrays[f"{number}_matrix"] = np.array(evaluated.matrix_world, dtype=np.float64)
            for key, value in surface(evaluated).items():
                arrays[f"{number}_{key}"] = value
    np.savez(result, **arrays)


def reveal(objects: Iterable[Any]) -> None:
    """Make all objects visible, because Blender does not update the poses of hidden objects."""

    def include(layer: Any) -> None:
        layer.exclude = layer.hide_viewport = False
        layer.collection.hide_viewport = False
        for child in layer.children:
            include(child)

    include(bpy.context.view_layer.layer_collection)
    placed = set(bpy.context.scene.objects)
    for obj in objects:
        obj.hide_viewport = False
        if obj not in placed:
            bpy.context.scene.collection.objects.link(obj)


def limit_subdivision(obj: Any) -> None:
    """Limit the size of subdivided meshes."""
    polygons = len(obj.data.polygons) if obj.type == "MESH" else 0
    for modifier in obj.modifiers:
        if modifier.type in ("SUBSURF", "MULTIRES"):
            while modifier.levels > 0 and polygons * 4**modifier.levels > MAX_POLYGONS:
                modifier.levels -= 1
            polygons *= 4**modifier.levels


def surface(evaluated: Any) -> dict[str, Any]:
    """The polygons of an evaluated object; empty if it has none."""
    if evaluated.type not in ("MESH", "CURVE", "SURFACE", "FONT", "META"):
        return {}
    mesh = evaluated.to_mesh()
    if mesh is None or not len(mesh.polygons):
        return {}
    found = {
        "vertices": values(mesh.vertices, "co", 3),
        "corners": values(mesh.loops, "vertex_index", 1, np.int32),
        "sizes": values(mesh.polygons, "loop_total", 1, np.int32),
        "materials": values(mesh.polygons, "material_index", 1, np.int32),
        "smooth": values(mesh.polygons, "use_smooth", 1, bool),
    }
    if hasattr(mesh, "corner_normals"):
        found["normals"] = values(mesh.corner_normals, "vector", 3)
    else:
        mesh.calc_normals_split()
        found["normals"] = values(mesh.loops, "normal", 3)
    layer = next((layer for layer in mesh.uv_layers if layer.active_render), None)
    if layer is not None:
        found["uvs"] = values(layer.data, "uv", 2)
    evaluated.to_mesh_clear()
    return found


def values(items: Any, name: str, width: int, kind: Any = np.float32) -> Any:
    """Return one attribute of many items as an array."""
    found = np.empty(len(items) * width, dtype=kind)
    items.foreach_get(name, found)
    return found if width == 1 else found.reshape(-1, width)


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1 :])
