"""Principled materials with at most one texture, which every viewer supports."""

from __future__ import annotations

import bpy

from common.colors import linear


def material(
    name: str,
    color: str = "#cccccc",
    roughness: float = 0.6,
    metallic: float = 0.0,
    image: bpy.types.Image | None = None,
    glow: float = 0.0,
    one_sided: bool = False,
) -> bpy.types.Material:
    """A surface with one colour, or one texture.

    Args:
        glow: strength of its emission.
        one_sided: back faces are not drawn, as for a ceiling that is transparent from above.
    """
    if name in bpy.data.materials:
        raise ValueError(f"material '{name}' exists already")
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    result.use_backface_culling = one_sided
    result.diffuse_color = (*linear(color), 1.0)
    result.roughness, result.metallic = roughness, metallic
    surface = next(node for node in result.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    surface.inputs["Base Color"].default_value = (*linear(color), 1.0)
    surface.inputs["Roughness"].default_value = roughness
    surface.inputs["Metallic"].default_value = metallic
    if glow:
        surface.inputs["Emission"].default_value = (*linear(color), 1.0)
        surface.inputs["Emission Strength"].default_value = glow
    if image is not None:
        picture = result.node_tree.nodes.new("ShaderNodeTexImage")
        picture.image = image
        picture.location = (-320, 300)
        result.node_tree.links.new(picture.outputs["Color"], surface.inputs["Base Color"])
    return result
