"""``.blend`` files as libraries of nodes."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from morse.plugins.blend.container import SIZE_LIMIT, BlendError, Damage, Excess, load
from morse.plugins.blend.evaluation import complete
from morse.plugins.blend.file import BlendFile
from morse.plugins.blend.images import Images
from morse.plugins.blend.instances import Collections, Instances
from morse.plugins.blend.materials import Materials, NodeTree
from morse.plugins.blend.meshes import Meshes
from morse.plugins.blend.objects import Objects
from morse.scene import Library, Mist

if TYPE_CHECKING:
    from morse.plugins.blend.file import Record
    from morse.scene import Node

#: the name of an object
_OBJECT = re.compile(rb"OB([A-Za-z_][\w.-]{0,60})\0")
_MIST = 1 << 0
_GRAVITY = 1 << 0
_FALLOFFS = {0: "QUADRATIC", 1: "LINEAR", 2: "INVERSE_QUADRATIC"}


def world_properties(file: BlendFile, scene: Record | None) -> dict[str, object]:
    """The properties of a `Library.world`, from the first scene."""
    if scene is None:
        return {}
    properties: dict[str, object] = {"gravity": _gravity(scene)}
    try:
        world = scene.follow("world", "World")
        if world is not None:
            properties.update(_appearance(world))
    except Damage as damage:
        file.warn(f"the world settings are damaged and are ignored: {damage}")
    return properties


def _gravity(scene: Record) -> float:
    """Downward acceleration, m/s^2."""
    if scene.has("gm"):
        return scene.part("gm").real("gravity", 9.81)
    if scene.has("physics_settings"):
        settings = scene.part("physics_settings")
        return -settings.reals("gravity", (0.0, 0.0, -9.81))[2] if settings.integer("flag", 1) & _GRAVITY else 0.0
    return 9.81


def _appearance(world: Record) -> dict[str, object]:
    horizon = tuple(world.real(f"hor{channel}", 0.05) for channel in "rgb")
    if world.integer("use_nodes", 0) or world.file.version >= 500:
        horizon = _background(world) or horizon
    properties: dict[str, object] = {"horizon_color": horizon}
    if world.has("ambr"):
        properties["ambient_color"] = tuple(world.real(f"amb{channel}", 0.0) for channel in "rgb")
    mode = world.integer("mode", 0)
    if mode & _MIST and world.file.version < 280:
        properties["mist"] = Mist(
            enabled=True,
            intensity=world.real("misi", 0.0),
            start=world.real("miststa", 5.0),
            depth=world.real("mistdist", 25.0),
            falloff=_FALLOFFS.get(world.integer("mistype", 0), "QUADRATIC"),
        )
    return properties


def _background(world: Record) -> tuple[float, float, float] | None:
    """The colour of the background node, times its strength."""
    record = world.follow("nodetree", "bNodeTree")
    output = None if record is None else NodeTree(record).output("ShaderNodeOutputWorld")
    background = None if output is None else output.source("Surface")
    if background is None or background.kind != "ShaderNodeBackground":
        return None
    strength = background.value("Strength", default=1.0)
    red, green, blue = background.color("Color", default=(0.05, 0.05, 0.05))
    return red * strength, green * strength, blue * strength


#: kinds of datablocks that cause a warning if they are in another file
_LINKED = ("OB", "ME", "GR", "MA", "IM")


def read_blend(path: str | Path, *, blender: str | None = None, size_limit: int = SIZE_LIMIT) -> Library:
    """Read a file saved by Blender 2.5 to 5.x.

    Args:
        path: the file; plain, gzip or zstd compressed.
        blender: the Blender program that evaluates modifiers and curves; by default the program in MORSE_BLENDER, or
            `blender` on the PATH.
        size_limit: maximum size of the file after decompression, bytes.

    Raises:
        BlendError: the file is broken, cut off, too large, or not a .blend file.
        OSError: it cannot be opened.
    """
    path = Path(path)
    try:
        return _read(path, blender, size_limit)
    except (Damage, Excess) as damage:
        raise BlendError(path, str(damage)) from damage


def object_names(path: Path) -> list[str]:
    """The names of the objects of a file, sorted; nothing else of it is read.

    Raises:
        BlendError: its compression is broken.
        OSError: it cannot be opened.
    """
    try:
        return sorted({name.decode() for name in _OBJECT.findall(load(path))})
    except Damage as damage:
        raise BlendError(path, str(damage)) from damage


def _read(path: Path, blender: str | None, size_limit: int) -> Library:
    file = BlendFile(load(path, size_limit))
    images = Images(path)
    materials = Materials(file, images)
    objects = Objects(file, materials, Meshes(materials))
    objects.connect()
    complete(path, file, objects, blender)
    collections = Collections(file)
    scene = _scene(file)
    order = [*collections.scene_objects(scene), *objects.nodes]
    inside = set(collections.scene_objects(scene))
    outside = {node.name for address, node in objects.nodes.items() if address not in inside} if inside else set()
    roots: dict[Node, None] = {}
    for address in order:
        node = objects.nodes.get(address)
        if node is not None and node.parent is None:
            roots[node] = None
    for copy in Instances(file, objects, collections).expand():
        roots[copy] = None
    libraries = [
        record.text("name")[2:] for record in file.datablocks("ID", "ID") if record.text("name")[:2] in _LINKED
    ]
    if libraries:
        more = f" and {len(libraries) - 1} more" if len(libraries) > 1 else ""
        file.warn(
            f"'{libraries[0]}'{more}: linked from other .blend files, which are not read; "
            "make them local in Blender (Object > Relations > Make Local)"
        )
    return Library(
        path=str(path),
        roots=list(roots),
        collections=collections.by_name({address: node.name for address, node in objects.nodes.items()}),
        outside_scene=outside,
        world=world_properties(file, scene),
        images=images.by_name,
        warnings=[*file.warnings, *images.warnings()],
    )


def _scene(file: BlendFile) -> Record | None:
    """The scene that was open when the file was saved, or else the first one."""
    scenes = {record.block.address: record for record in file.datablocks("SC", "Scene")}
    for record in file.datablocks("GLOB", "FileGlobal"):
        current = scenes.get(record.integer("curscene", 0))
        if current is not None:
            return current
    return next(iter(scenes.values()), None)
