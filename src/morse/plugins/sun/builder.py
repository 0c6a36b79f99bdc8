"""The class of street lamps in scene scripts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.components.robot import Robot
from morse.builder.errors import checks

if TYPE_CHECKING:
    from collections.abc import Iterable

_POST = (0.2, 0.22, 0.24)


class StreetLamp(Robot):
    """A lamp on a post that shines after sunset; its origin is on the floor, at the foot of the post.

    Args:
        name: its name, if it differs from the name of the variable that refers to it.
        height: m.
        energy: brightness, relative to a normal lamp.
        color: red, green, blue, 0 to 1.

    Raises:
        ValueError: a number is out of its range.
    """

    _classpath = "morse.plugins.sun.robots.street_lamp.StreetLamp"

    def __init__(
        self,
        name: str | None = None,
        *,
        height: float = 5.0,
        energy: float = 1.5,
        color: Iterable[float] = (1.0, 0.85, 0.6),
    ) -> None:
        tall = checks.number(height, "StreetLamp(height)", minimum=0.2, maximum=50.0)
        bright = checks.number(energy, "StreetLamp(energy)", minimum=0.0, maximum=1000.0)
        paint = checks.color(color, "StreetLamp(color)")
        from morse.assets.solids import cube
        from morse.scene import (
            BodySettings,
            CollisionShape,
            Light,
            Material,
            Mesh,
            Node,
            NodeKind,
            PhysicsType,
            ShapeKind,
        )

        super().__init__("", name)
        own = name or "street lamp"
        half, box = (0.06, 0.06, 0.5 * tall), cube()
        mesh = Mesh(
            f"{own} post",
            box.vertices * half,
            box.triangles,
            box.material_index,
            materials=(Material(f"{own} paint", color=(*_POST, 1.0), roughness=0.6),),
        )
        post = Node(f"{own} post", NodeKind.MESH, mesh=mesh, body=BodySettings(type=PhysicsType.STATIC))
        post.shapes = [CollisionShape(ShapeKind.BOX, half)]
        post.location = [0.0, 0.0, half[2]]
        head = Mesh(
            f"{own} head",
            box.vertices * (0.2, 0.12, 0.04),
            box.triangles,
            box.material_index,
            materials=(Material(f"{own} glass", color=(*paint, 1.0), shadeless=True),),
        )
        glass = Node(f"{own} head", NodeKind.MESH, mesh=head)
        glass.location = [0.15, 0.0, tall]
        bulb = Node(
            f"{own} bulb", NodeKind.LIGHT, light=Light("SPOT", paint, bright, 1.6 * tall, 2.0, casts_shadow=False)
        )
        bulb.location = [0.15, 0.0, tall - 0.06]
        for node in (post, glass, bulb):
            workspace.current().add(node)
            workspace.current().attach(self.scene_node, node)
