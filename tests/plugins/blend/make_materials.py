"""Creates one object for each kind of material: ``blender -b ... --python make_materials.py -- scene.blend``."""

import os
import sys

import bpy

path = sys.argv[-1]
bpy.ops.wm.read_factory_settings(use_empty=True)


def material(name: str) -> tuple[bpy.types.Material, bpy.types.NodeTree, bpy.types.NodeSocket]:
    """An object with a new material; its node tree with only the output, and the input of the output."""
    made = bpy.data.materials.new(name)
    made.use_nodes = True
    for node in list(made.node_tree.nodes):
        if node.type != "OUTPUT_MATERIAL":
            made.node_tree.nodes.remove(node)
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    mesh.materials.append(made)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new(name, mesh))
    return made, made.node_tree, made.node_tree.nodes["Material Output"].inputs["Surface"]


def shader(tree: bpy.types.NodeTree, kind: str, color: tuple = (), **values: float) -> bpy.types.Node:
    node = tree.nodes.new(kind)
    if color:
        node.inputs["Base Color" if "Principled" in kind else "Color"].default_value = (*color, 1)
    for key, value in values.items():
        node.inputs[key].default_value = value
    return node


def image(name: str, file: str | None) -> bpy.types.Image:
    made = bpy.data.images.new(name, 2, 2)
    if file:
        made.filepath_raw = os.path.join(os.path.dirname(path), file)
        made.file_format = "PNG"
        made.save()
        made.source = "FILE"
        made.filepath = "//" + file
    return made


def mix(
    tree: bpy.types.NodeTree, kind: str, first: bpy.types.Node, second: bpy.types.Node, factor: float
) -> bpy.types.Node:
    node = tree.nodes.new(kind)
    sockets = [socket for socket in node.inputs if socket.name == "Shader"]
    tree.links.new(first.outputs[0], sockets[0])
    tree.links.new(second.outputs[0], sockets[1])
    if "Fac" in node.inputs:
        node.inputs["Fac"].default_value = factor
    return node


_, tree, surface = material("emission")
tree.links.new(shader(tree, "ShaderNodeEmission", (0.5, 0.25, 1), Strength=2).outputs[0], surface)

_, tree, surface = material("rgb node")
diffuse, rgb = shader(tree, "ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeRGB")
rgb.outputs[0].default_value = (0.25, 0.5, 0.75, 1)
tree.links.new(rgb.outputs[0], diffuse.inputs["Color"])
tree.links.new(diffuse.outputs[0], surface)

_, tree, surface = material("metal")
tree.links.new(shader(tree, "ShaderNodeBsdfGlossy", (0.5, 0.5, 0.5), Roughness=0.25).outputs[0], surface)

_, tree, surface = material("translucent")
solid = shader(tree, "ShaderNodeBsdfPrincipled", (1, 0, 0))
tree.links.new(
    mix(tree, "ShaderNodeMixShader", shader(tree, "ShaderNodeBsdfTransparent"), solid, 0.25).outputs[0], surface
)

_, tree, surface = material("mostly green")
red, green = (shader(tree, "ShaderNodeBsdfDiffuse", color) for color in ((1, 0, 0), (0, 1, 0)))
tree.links.new(mix(tree, "ShaderNodeMixShader", red, green, 0.75).outputs[0], surface)

_, tree, surface = material("glowing")
red, glow = shader(tree, "ShaderNodeBsdfDiffuse", (1, 0, 0)), shader(tree, "ShaderNodeEmission", (0, 0, 1), Strength=3)
tree.links.new(mix(tree, "ShaderNodeAddShader", red, glow, 0).outputs[0], surface)

_, tree, surface = material("rerouted")
solid, muted, reroute = (
    shader(tree, "ShaderNodeBsdfPrincipled"), tree.nodes.new("ShaderNodeGamma"), tree.nodes.new("NodeReroute"),
)  # fmt: skip
rgb = tree.nodes.new("ShaderNodeRGB")
rgb.outputs[0].default_value = (0.25, 0.5, 0.75, 1)
muted.mute = True
tree.links.new(rgb.outputs[0], muted.inputs["Color"])
tree.links.new(muted.outputs[0], reroute.inputs[0])
tree.links.new(reroute.outputs[0], solid.inputs["Base Color"])
tree.links.new(solid.outputs[0], surface)

for name, file in (("external", "external.png"), ("generated", None)):
    _, tree, surface = material(name)
    solid = shader(tree, "ShaderNodeBsdfPrincipled")
    texture, mixed = tree.nodes.new("ShaderNodeTexImage"), tree.nodes.new("ShaderNodeMixRGB")
    texture.image = image(name, file)
    tree.links.new(texture.outputs["Color"], mixed.inputs["Color2"])
    tree.links.new(mixed.outputs[0], solid.inputs["Base Color"])
    tree.links.new(solid.outputs[0], surface)

made, tree, surface = material("no shader")
made.diffuse_color, made.roughness, made.metallic = (0.25, 0.5, 0.75, 1), 0.125, 0.5

made, tree, surface = material("no nodes")
tree.links.new(shader(tree, "ShaderNodeBsdfDiffuse", (1, 0, 0)).outputs[0], surface)
made.use_nodes = False
made.diffuse_color = (0.25, 0.5, 0.75, 0.5)

made, tree, surface = material("circle")
first, second = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new("ShaderNodeMixShader")
tree.links.new(first.outputs[0], second.inputs[1])
tree.links.new(second.outputs[0], first.inputs[1])
tree.links.new(second.outputs[0], surface)

bpy.ops.wm.save_as_mainfile(filepath=path, compress=True)
