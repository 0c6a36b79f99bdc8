"""The materials of furniture."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, ClassVar

from common.colors import BERRY, CORAL, CREAM, LEAF, NAVY, PLUM, SKY, STEEL, SUN, TEAL, WHITE
from common.materials import material
from common.shapes import rounded_box
from common.wood import Carpenter, wooden

if TYPE_CHECKING:
    from collections.abc import Callable

    import bpy

    from common.parts import Part


@dataclass
class Stock:
    """Materials of furniture; each is created on first use, so that files contain only used materials."""

    saw: Carpenter = field(default_factory=lambda: Carpenter(41))
    _made: dict[str, bpy.types.Material] = field(default_factory=dict)
    _later: dict[str, Callable[[], bpy.types.Material]] = field(default_factory=dict)

    _PLAIN: ClassVar = {
        "white": ("White", WHITE, 0.45, 0.0), "black": ("Black", NAVY, 0.45, 0.0), "steel": ("Steel", STEEL, 0.3, 0.9),
        "cream": ("Cream", CREAM, 0.8, 0.0), "teal": ("Teal", TEAL, 0.8, 0.0), "coral": ("Coral", CORAL, 0.7, 0.0),
        "red": ("Red", "#c2322e", 0.6, 0.0), "navy": ("Cloth", "#33475f", 0.9, 0.0), "sun": ("Sun", SUN, 0.7, 0.0),
        "sky": ("Sky", SKY, 0.7, 0.0), "leaf": ("Leaf", "#4f8f46", 0.8, 0.0),
        "light leaf": ("Light Leaf", LEAF, 0.8, 0.0), "glass": ("Pane", "#9cc3d4", 0.1, 0.0),
        "plum": ("Plum", PLUM, 0.7, 0.0), "berry": ("Berry", BERRY, 0.7, 0.0), "clay": ("Clay", "#b5653f", 0.85, 0.0),
        "soil": ("Earth", "#4b3527", 0.95, 0.0), "paper": ("Paper", "#fbfaf5", 0.8, 0.0),
        "stone": ("Stone", "#8b8f93", 0.7, 0.0),
    }  # fmt: skip
    _WOODS: ClassVar = {
        "oak": ("#a9743f", "#dcae76", 51),
        "birch": ("#cfae80", "#ecd7b2", 53),
        "walnut": ("#523420", "#86593a", 55),
    }

    def __getitem__(self, name: str) -> bpy.types.Material:
        if name not in self._made:
            if name in self._later:
                self._made[name] = self._later[name]()
            elif name in self._WOODS:
                dark, light, seed = self._WOODS[name]
                self._made[name] = wooden(name.title(), dark, light, seed, roughness=0.55)
            else:
                title, color, roughness, metallic = self._PLAIN[name]
                self._made[name] = material(title, color, roughness, metallic)
        return self._made[name]

    def add(self, name: str, make: Callable[[], bpy.types.Material]) -> None:
        """Another material, created on first use."""
        self._later[name] = make

    def board(self, x: float, y: float, z: float, wood: str, chamfer: float = 0.004) -> Part:
        return self.saw.board(x, y, z, self[wood], chamfer)

    def block(self, x: float, y: float, z: float, paint: str, round_: float = 0.01) -> Part:
        return rounded_box(x, y, z, min(round_, 0.45 * min(x, y, z)), 2).painted(self[paint])
