"""Materials: the nodes of shaders, and the settings of Blender before 2.80."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from morse.plugins.blend.container import Damage
from morse.plugins.blend.file import datablock_name
from morse.scene import Image, Material

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.plugins.blend.file import BlendFile, Record
    from morse.plugins.blend.images import Images

_MUTED = 1 << 9
_OUTPUT = 1 << 6
#: maximum number of reroutes and muted nodes between a socket and the node that feeds it
_DEPTH = 32


class Node:
    """A node of the tree.

    Attributes:
        kind: e.g. ``ShaderNodeBsdfPrincipled``.
    """

    def __init__(self, tree: NodeTree, record: Record) -> None:
        self.tree = tree
        self.record = record
        self.kind = record.text("idname") or _OLD_KINDS.get(record.integer("type"), "")

    @cached_property
    def inputs(self) -> list[Record]:
        """The input sockets."""
        return list(self.record.chain("inputs", "bNodeSocket"))

    @cached_property
    def _named_inputs(self) -> dict[str, Record]:
        # the first of each name
        return {socket.text("name"): socket for socket in reversed(self.inputs)}

    def socket(self, *names: str) -> Record | None:
        """The first input of one of these names."""
        return next((self._named_inputs[name] for name in names if name in self._named_inputs), None)

    def source(self, *names: str) -> Node | None:
        """The node that feeds an input."""
        socket = self.socket(*names)
        return None if socket is None else self.tree.source(socket)

    def value(self, *names: str, default: float) -> float:
        """Return the value of an unconnected input; the default otherwise."""
        socket = self.socket(*names)
        if socket is None or self.tree.source(socket) is not None:
            return default
        holder = socket.follow("default_value")
        return default if holder is None else holder.real("value", default)

    def color(self, *names: str, default: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return the colour of an input or of the RGB node that feeds it; the default otherwise."""
        socket = self.socket(*names)
        if socket is None:
            return default
        source = self.tree.source(socket)
        if source is not None:
            if source.kind != "ShaderNodeRGB":
                return default
            socket = next(source.record.chain("outputs", "bNodeSocket"), None)
        holder = None if socket is None else socket.follow("default_value")
        if holder is None:
            return default
        red, green, blue = holder.reals("value", default)
        return red, green, blue

    def image(self, *names: str) -> Record | None:
        """Return the image that feeds an input, directly or through nodes that change its colours."""
        source = self.source(*names)
        queue, nodes_so_far = [source] if source else [], set[Node]()
        while queue:
            node = queue.pop()
            if node in nodes_so_far:
                continue
            nodes_so_far.add(node)
            if node.kind in ("ShaderNodeTexImage", "ShaderNodeTexEnvironment"):
                return node.record.follow("id", "Image")
            sources = [self.tree.source(socket) for socket in node.inputs]
            queue.extend(source for source in reversed(sources) if source)
        return None


class NodeTree:
    """A shader node tree."""

    def __init__(self, record: Record) -> None:
        self.record = record
        self._nodes = {node.block.address: Node(self, node) for node in record.chain("nodes", "bNode")}
        self._sources = {
            link.integer("tosock"): link.integer("fromnode") for link in record.chain("links", "bNodeLink")
        }

    def nodes(self) -> Iterator[Node]:
        """All nodes."""
        yield from self._nodes.values()

    def source(self, socket: Record) -> Node | None:
        """The node that feeds a socket, directly or through reroutes and muted nodes."""
        for _ in range(_DEPTH):
            node = self._nodes.get(self._sources.get(socket.block.address, 0))
            if node is None or not (node.kind == "NodeReroute" or node.record.integer("flag") & _MUTED):
                return node
            entry_socket = next((entry for entry in node.inputs if entry.block.address in self._sources), None)
            if entry_socket is None:
                return None
            socket = entry_socket
        return None

    def output(self, kind: str) -> Node | None:
        """The active output node."""
        outputs = [node for node in self._nodes.values() if node.kind == kind]
        return next(
            (node for node in outputs if node.record.integer("flag") & _OUTPUT), outputs[0] if outputs else None
        )


#: numbers of the kinds before nodes had names of their kind (2.5 to 2.65)
_OLD_KINDS = {
    101: "ShaderNodeRGB", 124: "ShaderNodeOutputMaterial", 125: "ShaderNodeEmission", 126: "ShaderNodeBsdfDiffuse",
    128: "ShaderNodeMixShader", 129: "ShaderNodeAddShader", 140: "ShaderNodeEmission", 143: "ShaderNodeTexImage",
}  # fmt: skip


_DEPTH_OF_SHADERS = 8
_GREY, _WHITE, _BLACK = (0.8, 0.8, 0.8), (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)


def node_material(name: str, record: Record, images: Images) -> Material | None:
    """The material that a node tree describes, or None if it has no surface shader known here."""
    tree_record = record.follow("nodetree", "bNodeTree")
    if tree_record is None:
        return None
    tree = NodeTree(tree_record)
    output = tree.output("ShaderNodeOutputMaterial")
    shader = None if output is None else output.source("Surface")
    return None if shader is None else _shade(name, shader, images, _DEPTH_OF_SHADERS)


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


_SHADELESS, _TRANSPARENT = 1 << 2, 1 << 16
_MAP_COLOR = 1
_IMAGE_TEXTURE = 8
_OLD_BACKFACE_CULLING = 16


def old_material(name: str, record: Record, images: Images) -> Material:
    """A material with diffuse and specular settings and texture slots."""
    mode = record.integer("mode", 0)
    red, green, blue = (_share(record.real(channel, 0.8)) for channel in "rgb")
    alpha = _share(record.real("alpha", 1.0)) if mode & _TRANSPARENT else 1.0
    specular = _share(record.real("spec", 0.5))
    image = color_texture(record, images)
    if image is not None:
        # the texture replaces the colour
        red = green = blue = 1.0
    emit = max(record.real("emit", 0.0), 0.0)
    culls = record.has("game") and record.part("game").integer("flag", 0) & _OLD_BACKFACE_CULLING
    return Material(
        name,
        color=(red, green, blue, alpha),
        roughness=_roughness(specular, record.integer("har", 50)),
        emission=(red * emit, green * emit, blue * emit),
        specular=specular,
        image=image,
        shadeless=bool(mode & _SHADELESS),
        double_sided=not culls,
    )


def _roughness(specular: float, hardness: int) -> float:
    """The roughness whose highlight is as wide as that of a Blinn exponent: ``alpha^2 = 2 / (n + 2)``.

    Without specular light there is no highlight, for any exponent.
    """
    width: float = (2.0 / (max(hardness, 1) + 2.0)) ** 0.25
    return 1.0 - specular * (1.0 - width)


def color_texture(record: Record, images: Images) -> Image | None:
    """The image of the first texture slot that colours the surface."""
    for address in record.array("mtex"):
        slot = record.at(address, "MTex")
        if slot is None or not slot.integer("mapto", 0) & _MAP_COLOR:
            continue
        texture = slot.follow("tex", "Tex")
        if texture is None or texture.integer("type", 0) != _IMAGE_TEXTURE:
            continue
        source = texture.follow("ima", "Image")
        image = None if source is None else images.image(source)
        if image is not None:
            return image
    return None


_BACKFACE_CULLING = 1 << 2
_FACE_TEXTURES = 1 << 11
_MAX_SLOTS = 32_767


class Materials:
    """Reads each material once, for all meshes that use it."""

    def __init__(self, file: BlendFile, images: Images) -> None:
        self._file = file
        self._images = images
        self._read: dict[int, Material | None] = {}
        #: materials for images that are assigned to polygons (until 2.79)
        self.face_textured: set[Material] = set()

    def slots(self, holder: Record, field: str, count: int) -> list[Material | None]:
        """Return the materials of an array of pointers, e.g. the slots of a mesh."""
        return [self.at(address, holder) for address in holder.addresses(field, min(count, _MAX_SLOTS))]

    def image_at(self, address: int, holder: Record) -> Image | None:
        """The image at an address, or None."""
        record = holder.at(address, "Image")
        return None if record is None or record.block.code != "IM" else self._images.image(record)

    def at(self, address: int, holder: Record) -> Material | None:
        """The material at an address, or None for an empty slot."""
        if not address:
            return None
        if address not in self._read:
            block = self._file.block(address, holder.block.owner)
            index = self._file.dna.index("Material")
            if block is None or block.code != "MA" or index is None:
                self._read[address] = None
            else:
                self._read[address] = self._material(self._file.record(block, index))
        return self._read[address]

    def _material(self, record: Record) -> Material:
        name = datablock_name(record)
        try:
            material = node_material(name, record, self._images) if _uses_nodes(record) else None
            if material is not None:
                material.double_sided = not record.integer("blend_flag", 0) & _BACKFACE_CULLING
                return material
            if record.has("mtex"):
                material = old_material(name, record, self._images)
                if record.integer("mode", 0) & _FACE_TEXTURES:
                    self.face_textured.add(material)
                return material
            return plain_material(name, record)
        except Damage as damage:
            self._file.warn(f"the material '{name}' is damaged and is shown in grey: {damage}")
            return Material(name)


def _uses_nodes(record: Record) -> bool:
    return bool(record.integer("nodetree", 0)) and bool(record.integer("use_nodes", 0) or record.file.version >= 500)


def plain_material(name: str, record: Record) -> Material:
    """A material without nodes, as the viewport of Blender 2.80 and later shows it."""
    red, green, blue = (record.real(channel, 0.8) for channel in "rgb")
    return Material(
        name,
        color=(red, green, blue, min(max(record.real("a", 1.0), 0.0), 1.0)),
        metallic=record.real("metallic", 0.0),
        roughness=record.real("roughness", 0.4),
        specular=record.real("spec", 0.5),
        double_sided=not record.integer("blend_flag", 0) & _BACKFACE_CULLING,
    )
