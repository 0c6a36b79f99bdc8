"""The nodes of a scene under the names of Blender's objects, for scripts that know them.

``robot._bpy_object`` and ``bpymorse.get_object(name)`` are such objects. They have no data of their own: the node is
read and written.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NoReturn

from morse.builder import workspace
from morse.builder.blender.game import GameSettings
from morse.builder.blender.named import NamedList
from morse.builder.blender.pose import LiveEuler, LiveVector
from morse.builder.errors import checks
from morse.builder.errors.angles import hint_at_radians
from morse.builder.errors.attributes import unknown_attribute

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.scene import Material, Node


class SceneObject:
    """A node of the scene.

    Two objects are equal if they refer to the same node.
    """

    __slots__ = ("node",)

    def __init__(self, node: Node) -> None:
        self.node = node

    def __eq__(self, other: object) -> bool:
        return isinstance(other, SceneObject) and other.node is self.node

    def __hash__(self) -> int:
        return hash(self.node)

    def __repr__(self) -> str:
        return f"<SceneObject '{self.node.name}'>"

    if not TYPE_CHECKING:  # lets type checkers find misspelt names

        def __getattr__(self, name: str) -> NoReturn:
            unknown_attribute(self, name)

    @property
    def name(self) -> str:
        """The name, unique in the scene: ``.001``, ``.002``, ... is appended to an existing name."""
        return self.node.name

    @name.setter
    def name(self, name: str) -> None:
        workspace.current().rename(self.node, checks.text(name, "name"))

    @property
    def location(self) -> LiveVector:
        """Metres, in the frame of the parent."""
        return LiveVector(self.node.location, "location")

    @location.setter
    def location(self, value: Iterable[float]) -> None:
        self.node.location[:] = checks.triple(value, "location")

    @property
    def rotation_euler(self) -> LiveEuler:
        """Radians, XYZ order, in the frame of the parent."""
        return LiveEuler(self.node.rotation_euler, "rotation_euler")

    @rotation_euler.setter
    def rotation_euler(self, value: Iterable[float]) -> None:
        angles = checks.triple(value, "rotation_euler")
        hint_at_radians("rotation_euler", angles)
        self.node.rotation_euler[:] = angles

    @property
    def scale(self) -> LiveVector:
        """Factor along each axis."""
        return LiveVector(self.node.scale, "scale")

    @scale.setter
    def scale(self, value: Iterable[float]) -> None:
        self.node.scale[:] = checks.triple(value, "scale")

    @property
    def parent(self) -> SceneObject | None:
        """The parent object, or None for the world."""
        return None if self.node.parent is None else SceneObject(self.node.parent)

    @parent.setter
    def parent(self, parent: SceneObject | None) -> None:
        if parent is None:
            workspace.current().detach(self.node)
        elif isinstance(parent, SceneObject):
            workspace.current().attach(parent.node, self.node)
        else:
            raise TypeError(f"parent takes an object of the scene or None, got {checks.shown(parent)}")

    @property
    def children(self) -> NamedList[SceneObject]:
        """The child objects."""
        return NamedList([SceneObject(child) for child in self.node.children], "child")

    @property
    def material_slots(self) -> NamedList[MaterialSlot]:
        """The surfaces of its mesh; their names are those of the materials."""
        return NamedList([MaterialSlot(self.node, index) for index in range(len(material_slots(self.node)))], "slot")

    @property
    def game(self) -> GameSettings:
        """Physics and properties."""
        return GameSettings(self.node)


def material_slots(node: Node) -> list[Material | None]:
    """Return the materials of a node: its own, else those of its mesh."""
    defaults = list(node.mesh.materials) if node.mesh is not None else []
    slots = [*node.materials, *defaults[len(node.materials) :]]
    return [own if own is not None else defaults[i] if i < len(defaults) else None for i, own in enumerate(slots)]


class MaterialSlot:
    """One surface of a mesh."""

    __slots__ = ("_index", "_node")

    def __init__(self, node: Node, index: int) -> None:
        self._node = node
        self._index = index

    @property
    def name(self) -> str:
        """The name of the material, or an empty string."""
        material = material_slots(self._node)[self._index]
        return "" if material is None else material.name

    @property
    def material(self) -> ObjectMaterial | None:
        """The material, or None if the slot is empty."""
        material = material_slots(self._node)[self._index]
        return None if material is None else ObjectMaterial(self._node, self._index)


class ObjectMaterial:
    """The material of one slot; a change affects this object only."""

    __slots__ = ("_index", "_node")

    def __init__(self, node: Node, index: int) -> None:
        self._node = node
        self._index = index

    def _read(self) -> Material:
        material = material_slots(self._node)[self._index]
        assert material is not None
        return material

    def _write(self, **changes: Any) -> None:
        slots = material_slots(self._node)
        slots[self._index] = replace(self._read(), **changes)
        self._node.materials[:] = slots

    if not TYPE_CHECKING:  # lets type checkers find misspelt names

        def __getattr__(self, name: str) -> NoReturn:
            unknown_attribute(self, name)

    @property
    def name(self) -> str:
        """Its name."""
        return self._read().name

    @property
    def diffuse_color(self) -> tuple[float, float, float]:
        """Linear RGB, 0..1."""
        return self._read().color[:3]

    @diffuse_color.setter
    def diffuse_color(self, value: Iterable[float]) -> None:
        self._write(color=(*checks.color(list(value)[:3], "diffuse_color"), self.alpha))

    @property
    def alpha(self) -> float:
        """Opacity: 0 is invisible, 1 is opaque."""
        return self._read().color[3]

    @alpha.setter
    def alpha(self, value: float) -> None:
        opacity = checks.number(value, "alpha", minimum=0.0)
        self._write(color=(*self.diffuse_color, min(opacity, 1.0)))
