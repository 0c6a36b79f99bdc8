"""Shader node trees as metallic-roughness materials."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.blend.nodes import Node, NodeTree
from morse.scene import Material

if TYPE_CHECKING:
    from morse.assets.blend.images import Images
    from morse.assets.blend.record import Record

_DEPTH = 8
_GREY, _WHITE, _BLACK = (0.8, 0.8, 0.8), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)


def node_material(name: str, record: Record, images: Images) -> Material | None:
    """The material that a node tree describes, or None if it has no surface shader known here."""
    tree_record = record.follow("nodetree", "bNodeTree")
    if tree_record is None:
        return None
    tree = NodeTree(tree_record)
    output = tree.output("ShaderNodeOutputMaterial")
    shader = None if output is None else output.source("Surface")
    return None if shader is None else _shade(name, shader, images, _DEPTH)


def _shade(name: str, shader: Node, images: Images, depth: int) -> Material | None:
    if depth == 0:
        return None
    kind = shader.kind.removeprefix("ShaderNode")
    if kind in ("MixShader", "AddShader"):
        return _mixed(name, shader, images, depth)
    if kind == "BsdfPrincipled":
        return _principled(name, shader, images)
    if kind == "Emission":
        strength = shader.value("Strength", default=1.0)
        base = _surface(name, shader, images)
        base.emission = _times(base.color[:3], strength)
        base.shadeless = True
        return base
    if kind in ("BsdfTransparent", "Holdout"):
        return Material(name, color=(*shader.color("Color", default=_WHITE), 0.0))
    surface = _SURFACES.get(kind)
    if surface is None:
        return None
    material = _surface(name, shader, images)
    material.metallic, roughness, alpha = surface
    material.roughness = shader.value("Roughness", default=roughness) if kind != "BsdfDiffuse" else roughness
    material.color = (*material.color[:3], alpha)
    return material


#: simple shaders: metallic, roughness if the node has no such input, alpha
_SURFACES = {
    "BsdfDiffuse": (0.0, 1.0, 1.0),
    "BsdfGlossy": (1.0, 0.2, 1.0),
    "BsdfAnisotropic": (1.0, 0.2, 1.0),
    "BsdfMetallic": (1.0, 0.3, 1.0),
    "BsdfGlass": (0.0, 0.0, 0.3),
    "BsdfRefraction": (0.0, 0.0, 0.3),
    "BsdfTranslucent": (0.0, 1.0, 1.0),
    "BsdfToon": (0.0, 1.0, 1.0),
    "BsdfVelvet": (0.0, 1.0, 1.0),
    "BsdfSheen": (0.0, 1.0, 1.0),
    "SubsurfaceScattering": (0.0, 0.8, 1.0),
    "EeveeSpecular": (0.0, 0.2, 1.0),
}


def _surface(name: str, shader: Node, images: Images) -> Material:
    """A material with the colour of the shader."""
    color, image = shader.color("Color", "Base Color", default=_GREY), shader.image("Color", "Base Color")
    picture = None if image is None else images.image(image)
    return Material(name, color=(*(color if picture is None else _WHITE), 1.0), image=picture)


def _principled(name: str, shader: Node, images: Images) -> Material:
    material = _surface(name, shader, images)
    material.color = (*material.color[:3], _share(shader.value("Alpha", default=1.0)))
    material.metallic = _share(shader.value("Metallic", default=0.0))
    material.roughness = _share(shader.value("Roughness", default=0.5))
    material.specular = _share(shader.value("Specular IOR Level", "Specular", default=0.5))
    glow = shader.color("Emission Color", "Emission", default=_BLACK)
    material.emission = _times(glow, shader.value("Emission Strength", default=1.0))
    return material


def _mixed(name: str, shader: Node, images: Images, depth: int) -> Material | None:
    """Return the shader with the larger weight; if the other one is transparent, it is made translucent."""
    factor = _share(shader.value("Fac", "Factor", default=0.5)) if shader.kind == "ShaderNodeMixShader" else 0.5
    sockets = [socket for socket in shader.inputs if socket.text("name") == "Shader"][:2]
    sources = [shader.tree.source(socket) for socket in sockets]
    parts: list[tuple[float, Material, bool]] = []
    for weight, source in zip((1.0 - factor, factor), sources, strict=False):
        material = None if source is None else _shade(name, source, images, depth - 1)
        if source is not None and material is not None:
            parts.append((weight, material, source.kind == "ShaderNodeBsdfTransparent"))
    if not parts:
        return None
    clear = next((weight for weight, _, transparent in parts if transparent), 0.0)
    weight, heaviest, _ = max(parts, key=lambda entry: (not entry[2], entry[0]))
    if clear and shader.kind == "ShaderNodeMixShader":
        heaviest.color = (*heaviest.color[:3], heaviest.color[3] * (1.0 - clear))
    if shader.kind == "ShaderNodeAddShader":
        heaviest.emission = max((material.emission for _, material, _ in parts), key=sum)
        heaviest.shadeless = all(material.shadeless for _, material, _ in parts)
    return heaviest


def _share(value: float) -> float:
    return min(max(value, 0.0), 1.0)


def _times(color: tuple[float, ...], factor: float) -> tuple[float, float, float]:
    red, green, blue = (max(channel * factor, 0.0) for channel in color[:3])
    return red, green, blue
