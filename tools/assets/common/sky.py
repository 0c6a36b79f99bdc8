"""The lighting of a world: colour of the sky, a sun, and light from the sky."""

from __future__ import annotations

import bpy

from common.colors import linear
from common.objects import lamp


def sky(color: str, strength: float = 0.8) -> None:
    """The background of the world, and its light."""
    world = bpy.data.worlds.new("World")
    world.color = linear(color)
    world.use_nodes = True
    background = next(node for node in world.node_tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (*linear(color), 1.0)
    background.inputs["Strength"].default_value = strength
    bpy.context.scene.world = world


def sunshine(energy: float = 3.0, turned: tuple[float, float, float] = (0.62, 0.18, 0.9)) -> None:
    lamp("Sun", "SUN", energy, (8.0, -8.0, 18.0), turned, color="#fff1d8")
