"""What pages are told of the objects of a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, cast

from morse.viewer.describe import describe_light
from morse.viewer.snapshot import MovingNode
from morse.viewer.view_messages import Appearance

if TYPE_CHECKING:
    from collections.abc import Iterator

    from morse.physics import World
    from morse.scene import Image


def moving_nodes(world: World) -> list[MovingNode]:
    """The nodes whose poses pages get."""
    return [MovingNode(node, cast('Literal["world", "parent"]', frame)) for node, frame in world.moving_nodes()]


def pictured(world: World, images: dict[str, Image | None]) -> bool:
    """Whether an object whose appearance has changed has another texture than before.

    Args:
        images: textures by name, which are updated.
    """
    images_now = {obj.name: obj.node.image for obj in world.repainted if obj.node.image is not images.get(obj.name)}
    images.update(images_now)
    return bool(images_now)


def appearances(world: World) -> Iterator[Appearance]:
    """The objects whose appearance has changed since the last call."""
    for obj in sorted(world.repainted, key=lambda one: one.name):
        light = None if obj.node.light is None else describe_light(obj.node.light)
        yield Appearance(obj.name, obj.visible, obj.node.color, light)
    world.repainted.clear()
