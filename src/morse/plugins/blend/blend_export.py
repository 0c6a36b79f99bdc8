"""Runs inside Blender: evaluates meshes and poses of some objects and writes them as arrays.

``blender -b --python blend_export.py -- source.blend result.npz names.json``. It imports nothing but Blender's own
module and the standard library, and runs in a process of its own: the Blender of Debian has no numpy unless the package
``python3-numpy`` is installed.
"""

from __future__ import annotations

import json
import struct
import sys
import zipfile
from array import array
from typing import TYPE_CHECKING, Any

import bpy  # type: ignore[import-not-found]

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
        request = json.load(file)
    objects = {obj.name: obj for obj in bpy.data.objects if obj.library is None}
    reveal(objects.values())
    for name in request:
        if name in objects:
            limit_subdivision(objects[name])
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    arrays: dict[str, bytes] = {}
    for number, name in enumerate(request):
        if name in objects:
            evaluated = objects[name].evaluated_get(depsgraph)
            matrix = array("d", [value for row in evaluated.matrix_world for value in row])
            arrays[f"{number}_matrix"] = encoded(matrix, 4)
            for key, value in surface(evaluated).items():
                arrays[f"{number}_{key}"] = value
    with zipfile.ZipFile(result, "w") as archive:
        for key, data in arrays.items():
            archive.writestr(f"{key}.npy", data)


def reveal(objects: Iterable[Any]) -> None:
    """Make all objects visible, because Blender does not update the poses of hidden objects."""

    def include(layer: Any) -> None:
        layer.exclude = layer.hide_viewport = False
        layer.collection.hide_viewport = False
        for child in layer.children:
            include(child)

    include(bpy.context.view_layer.layer_collection)
    scene_objects = set(bpy.context.scene.objects)
    for obj in objects:
        obj.hide_viewport = False
        if obj not in scene_objects:
            bpy.context.scene.collection.objects.link(obj)


def limit_subdivision(obj: Any) -> None:
    """Limit the size of subdivided meshes."""
    polygons = len(obj.data.polygons) if obj.type == "MESH" else 0
    for modifier in obj.modifiers:
        if modifier.type in ("SUBSURF", "MULTIRES"):
            while modifier.levels > 0 and polygons * 4**modifier.levels > MAX_POLYGONS:
                modifier.levels -= 1
            polygons *= 4**modifier.levels


def surface(evaluated: Any) -> dict[str, bytes]:
    """The polygons of an evaluated object as encoded arrays; empty if it has none."""
    if evaluated.type not in ("MESH", "CURVE", "SURFACE", "FONT", "META"):
        return {}
    mesh = evaluated.to_mesh()
    if mesh is None or not len(mesh.polygons):
        return {}
    arrays = {
        "vertices": values(mesh.vertices, "co", 3),
        "corners": values(mesh.loops, "vertex_index", 1, "i"),
        "sizes": values(mesh.polygons, "loop_total", 1, "i"),
        "materials": values(mesh.polygons, "material_index", 1, "i"),
        "smooth": values(mesh.polygons, "use_smooth", 1, "b"),
    }
    if hasattr(mesh, "corner_normals"):
        arrays["normals"] = values(mesh.corner_normals, "vector", 3)
    else:
        mesh.calc_normals_split()
        arrays["normals"] = values(mesh.loops, "normal", 3)
    layer = next((layer for layer in mesh.uv_layers if layer.active_render), None)
    if layer is not None:
        arrays["uvs"] = values(layer.data, "uv", 2)
    evaluated.to_mesh_clear()
    return arrays


def values(items: Any, name: str, width: int, kind: str = "f") -> bytes:
    """One attribute of many items as an encoded array.

    Args:
        width: number of values of each item.
        kind: type code of the module ``array``: ``f``, ``i`` or ``b`` for truth values.
    """
    buffer = array(kind, bytes(len(items) * width * array(kind).itemsize))
    items.foreach_get(name, buffer)
    return encoded(buffer, width)


#: types of numpy for the type codes of the module ``array``
_TYPES = {"d": "f8", "f": "f4", "i": "i4", "b": "b1"}


def encoded(numbers: array[Any], width: int) -> bytes:
    """An array in the format .npy (version 1.0) of numpy; with one column, it has one dimension."""
    rows = len(numbers) // width
    shape = f"({rows},)" if width == 1 else f"({rows}, {width})"
    order = "|" if numbers.itemsize == 1 else "<" if sys.byteorder == "little" else ">"
    header = f"{{'descr': '{order}{_TYPES[numbers.typecode]}', 'fortran_order': False, 'shape': {shape}, }}"
    # the data begin at a multiple of 64 bytes
    padding = -(10 + len(header) + 1) % 64
    text = f"{header}{' ' * padding}\n".encode("latin1")
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + numbers.tobytes()


if __name__ == "__main__":
    main(*sys.argv[sys.argv.index("--") + 1 :])
