"""World settings of a file: gravity, horizon, mist."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.blend.errors import Damage
from morse.assets.blend.nodes import NodeTree
from morse.scene import Mist

if TYPE_CHECKING:
    from morse.assets.blend.file import BlendFile
    from morse.assets.blend.record import Record

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
