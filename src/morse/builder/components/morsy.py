"""The robot Morsy."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from morse.builder import workspace
from morse.builder.components.declared import DeclaredRobot
from morse.builder.components.robot import GroundRobot
from morse.builder.errors import checks
from morse.builder.objects import material_slots

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene import Material

_MORSY_COLORS = ((0.9, 0.35, 0.1), (0.1, 0.45, 0.8), (0.2, 0.6, 0.25), (0.75, 0.1, 0.3), (0.45, 0.25, 0.7))


class Morsy(DeclaredRobot, GroundRobot):
    """The mascot of MORSE, a small rigid robot to drive around."""

    _classpath = "morse.robots.morsy.Morsy"

    def __init__(self, name: str | None = None) -> None:
        super().__init__(name)
        self.set_collision_bounds()
        self.scene_node.body.radius = 0.08

    def set_color(
        self, color: Iterable[float] | float | None = None, g: float | None = None, b: float | None = None
    ) -> None:
        """Set the colour of its body.

        Args:
            color: red, green and blue, 0..1, as one sequence; None for a colour that depends on the number of such
                robots.
            g: green, if ``color`` is only red.
            b: blue, if ``color`` is only red.
        """
        if color is None:
            row = [robot for robot in workspace.current().components if isinstance(robot, Morsy)]
            color = _MORSY_COLORS[row.index(self) % len(_MORSY_COLORS)]
        elif g is not None or b is not None:
            color = (color, g or 0.0, b or 0.0)  # type: ignore[assignment]
        rgb = checks.color(color, "Morsy.set_color(color)")
        copies: dict[Material | None, Material] = {}
        for node in self.own_nodes():
            slots = material_slots(node)
            for material in slots:
                if material is not None and "body" in material.name.lower():
                    copies.setdefault(material, replace(material, color=(*rgb, material.color[3])))
            node.materials[:] = [copies.get(material, material) for material in slots]
