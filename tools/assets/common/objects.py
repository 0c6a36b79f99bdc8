"""Blender objects from parts, with their physics."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import bpy
import numpy as np

from common.colors import linear
from common.parts import fitted
from common.shapes import box, cylinder
from mathutils import Euler, Vector

if TYPE_CHECKING:
    from collections.abc import Sequence

    from common.parts import Part

Triple = tuple[float, float, float]
ORIGIN = (0.0, 0.0, 0.0)


def collection(name: str) -> bpy.types.Collection:
    result = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(result)
    return result


def empty(name: str, at: Triple = ORIGIN, turned: Triple = ORIGIN, **options: object) -> bpy.types.Object:
    """A node without a mesh. Position (m) and Euler XYZ (rad) are those in the world; see `_place` for the options."""
    result = bpy.data.objects.new(name, None)
    result.empty_display_size = 0.3
    return _place(result, at, turned, **options)


def instance(
    source: bpy.types.Collection, name: str, at: Triple, turned: Triple = ORIGIN, **options: object
) -> bpy.types.Object:
    """An empty that instantiates a collection."""
    result = bpy.data.objects.new(name, None)
    result.instance_type, result.instance_collection = "COLLECTION", source
    return _place(result, at, turned, **options)


def solid(
    name: str, parts: Sequence[Part], at: Triple = ORIGIN, turned: Triple = ORIGIN, **options: object
) -> bpy.types.Object:
    """A visible object; the parts are given in its own frame."""
    mesh = bpy.data.meshes.new(name)
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    faces = [[int(start) + i for i in face] for part, start in zip(parts, starts, strict=False) for face in part.faces]
    mesh.from_pydata(np.concatenate([part.vertices for part in parts]).tolist(), [], faces)
    slots = list(dict.fromkeys(part.material for part in parts if part.material is not None))
    for material in slots:
        mesh.materials.append(material)
    per_face = [(part, k) for part in parts for k in range(len(part.faces))]
    mesh.polygons.foreach_set("material_index", [slots.index(p.material) if p.material else 0 for p, _ in per_face])
    mesh.polygons.foreach_set("use_smooth", [part.smooth for part, _ in per_face])
    if any(part.uvs is not None for part in parts):
        layer = mesh.uv_layers.new(name="UVMap")
        corners = [p.uvs[k] if p.uvs is not None else np.zeros((len(p.faces[k]), 2)) for p, k in per_face]
        layer.data.foreach_set("uv", np.concatenate(corners).astype(np.float32).ravel())
    if mesh.validate():
        raise ValueError(f"the mesh of '{name}' has degenerate or double faces")
    return _place(bpy.data.objects.new(name, mesh), at, turned, **options)


def twin(
    original: bpy.types.Object, name: str, at: Triple, turned: Triple = ORIGIN, **options: object
) -> bpy.types.Object:
    """Another object with the same mesh."""
    return _place(bpy.data.objects.new(name, original.data), at, turned, **options)


def hidden_shape(
    name: str, parts: Sequence[Part], at: Triple = ORIGIN, turned: Triple = ORIGIN, **options: object
) -> bpy.types.Object:
    """An invisible collision shape: Blender shows its edges, renderers and viewers do not."""
    result = solid(name, parts, at, turned, **options)
    result.hide_render = True
    result.display_type = "WIRE"
    result["visible"] = 0
    return result


def hidden_box(
    name: str, size: Triple, at: Triple = ORIGIN, turned: Triple = ORIGIN, **options: object
) -> bpy.types.Object:
    return hidden_shape(name, [box(*size)], at, turned, **{"collision": "box", **options})


def hidden_cylinder(
    name: str, radius: float, height: float, at: Triple = ORIGIN, **options: object
) -> bpy.types.Object:
    return hidden_shape(name, [cylinder(radius, height)], at, **{"collision": "cylinder", **options})


def exact(
    name: str,
    parts: Sequence[Part],
    size: Triple,
    centre: Triple,
    at: Triple = ORIGIN,
    turned: Triple = ORIGIN,
    **options: object,
) -> bpy.types.Object:
    """A visible object stretched to the given bounding box in its own frame."""
    return solid(name, fitted(parts, size, centre), at, turned, **options)


def lamp(
    name: str,
    kind: str,
    energy: float,
    at: Triple,
    turned: Triple = ORIGIN,
    color: str = "#ffffff",
    shadow: bool = True,
) -> bpy.types.Object:
    """A light that shines along its -Z axis; energy in W (SUN: W/m^2)."""
    data = bpy.data.lights.new(name, kind)
    data.energy = energy
    data.color = linear(color)
    data.use_shadow = shadow
    if kind == "SUN":
        data.angle = 0.02
    return _place(bpy.data.objects.new(name, data), at, turned)


def viewpoint(at: Triple, target: Triple, lens: float = 20.0) -> bpy.types.Object:
    """The camera ``CameraFP``, the initial viewpoint of the live view, and its target; lens in mm."""
    data = bpy.data.cameras.new("CameraFP")
    data.lens, data.sensor_width = lens, 32.0
    way = Vector(target) - Vector(at)
    pitch, yaw = math.atan2(way.z, math.hypot(way.x, way.y)), math.atan2(way.y, way.x)
    turned = (math.pi / 2 + pitch, 0.0, yaw - math.pi / 2)
    return _place(bpy.data.objects.new("CameraFP", data), at, turned)


def _place(
    result: bpy.types.Object,
    at: Triple,
    turned: Triple,
    parent: bpy.types.Object | None = None,
    within: bpy.types.Collection | None = None,
    **properties: object,
) -> bpy.types.Object:
    """Link, pose and tag an object.

    Args:
        at: metres, in the world frame, also for children.
        turned: Euler XYZ in the world frame, rad.
        within: its collection; default: that of the parent, or the scene's.
        properties: physics (``physics_type``, ``collision``, ``mass``, ...) and semantic tags (``Object``, ...).
    """
    home = within or (parent.users_collection[0] if parent else bpy.context.scene.collection)
    home.objects.link(result)
    result.location, result.rotation_euler = at, turned
    if parent is not None:
        result.parent = parent
        bpy.context.view_layer.update()
        inside = parent.matrix_world.inverted()
        result.location = inside @ Vector(at)
        turn = inside.to_3x3()
        if not turn.is_identity:  # else the angles are kept, although other angles may give the same rotation
            result.rotation_euler = (turn @ Euler(turned).to_matrix()).to_euler()
    for key, value in properties.items():
        result[key] = value
    return result
