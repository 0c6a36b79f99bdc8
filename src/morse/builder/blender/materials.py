"""Materials under the names of Blender."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from morse.builder import workspace
from morse.builder.errors import checks
from morse.builder.errors.attributes import unknown_attribute
from morse.builder.legacy.ignored import Ignored
from morse.builder.legacy.notices import notice

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.scene import Material, Node


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

    @material.setter
    def material(self, value: ObjectMaterial | SharedMaterial | None) -> None:
        slots = material_slots(self._node)
        slots[self._index] = None if value is None else value.read()
        self._node.materials[:] = slots


#: settings of materials in Blender that MORSE does not have
_WITHOUT_EFFECT = (
    "ambient", "darkness", "diffuse_intensity", "diffuse_shader", "game_settings", "halo", "mirror_color",
    "pass_index", "physics", "raytrace_mirror", "raytrace_transparency", "roughness", "shadow_ray_bias",
    "specular_alpha", "specular_color", "specular_hardness", "specular_shader", "subsurface_scattering",
    "texture_slots", "translucency", "transparency_method", "type", "use_cast_buffer_shadows",
    "use_cast_shadows", "use_face_texture", "use_face_texture_alpha", "use_mist", "use_nodes", "use_object_color",
    "use_raytrace", "use_shadows", "use_transparency", "use_transparent_shadows", "use_vertex_color_paint",
)  # fmt: skip


class _Surface:
    """A material; subclasses say where it is stored."""

    if not TYPE_CHECKING:  # lets type checkers find misspelt names

        def __getattr__(self, name: str) -> Ignored:
            if name not in _WITHOUT_EFFECT:
                unknown_attribute(self, name)
            return Ignored(f"material.{name}")

    def __setattr__(self, name: str, value: object) -> None:
        if name in _WITHOUT_EFFECT:
            notice(f"material.{name} has no effect")
        elif name.startswith("_") or hasattr(type(self), name):
            object.__setattr__(self, name, value)
        else:
            unknown_attribute(self, name)

    def read(self) -> Material:
        """The material as the scene has it."""
        raise NotImplementedError

    def _write(self, **changes: object) -> None:
        raise NotImplementedError

    @property
    def name(self) -> str:
        """Its name."""
        return self.read().name

    @name.setter
    def name(self, value: str) -> None:
        self._write(name=checks.text(value, "material.name"))

    @property
    def diffuse_color(self) -> tuple[float, float, float]:
        """Linear RGB, 0..1."""
        return self.read().color[:3]

    @diffuse_color.setter
    def diffuse_color(self, value: Iterable[float]) -> None:
        self._write(color=(*checks.color(list(value)[:3], "diffuse_color"), self.alpha))

    @property
    def alpha(self) -> float:
        """Opacity: 0 is invisible, 1 is opaque."""
        return self.read().color[3]

    @alpha.setter
    def alpha(self, value: float) -> None:
        opacity = checks.number(value, "alpha", minimum=0.0)
        self._write(color=(*self.diffuse_color, min(opacity, 1.0)))

    @property
    def specular_intensity(self) -> float:
        """Specular reflection, 0..1."""
        return self.read().specular

    @specular_intensity.setter
    def specular_intensity(self, value: float) -> None:
        self._write(specular=min(checks.number(value, "specular_intensity", minimum=0.0), 1.0))

    @property
    def use_shadeless(self) -> bool:
        """Whether it is shown in its own colour, without lighting."""
        return self.read().shadeless

    @use_shadeless.setter
    def use_shadeless(self, value: bool) -> None:
        self._write(shadeless=checks.boolean(value, "use_shadeless"))

    @property
    def emit(self) -> float:
        """Emission as a factor of its own colour."""
        return max(self.read().emission) / (max(self.diffuse_color) or 1.0)

    @emit.setter
    def emit(self, value: float) -> None:
        strength = checks.number(value, "emit", minimum=0.0)
        self._write(emission=tuple(strength * channel for channel in self.diffuse_color))


class ObjectMaterial(_Surface):
    """The material of one slot; a change affects this object only."""

    def __init__(self, node: Node, index: int) -> None:
        self._node = node
        self._index = index

    def read(self) -> Material:
        """The material as the scene has it."""
        material = material_slots(self._node)[self._index]
        assert material is not None
        return material

    def _write(self, **changes: Any) -> None:
        slots = material_slots(self._node)
        slots[self._index] = replace(self.read(), **changes)
        self._node.materials[:] = slots


class SharedMaterial(_Surface):
    """A material of ``bpy.data.materials``; a change affects all objects with this material."""

    def __init__(self, material: Material) -> None:
        self._material = material

    def read(self) -> Material:
        """The material as the scene has it."""
        return self._material

    def _write(self, **changes: Any) -> None:
        before, self._material = self._material, replace(self._material, **changes)
        own = workspace.current().materials
        own[:] = [self._material if material is before else material for material in own]
        for node in workspace.current().nodes():
            slots = material_slots(node)
            if any(material is before for material in slots):
                node.materials[:] = [self._material if material is before else material for material in slots]


def all_materials() -> Iterator[Material]:
    """The materials that a script has created, and those of the objects in the scene, each once."""
    visited: set[int] = set()
    slots = (material for node in workspace.current().nodes() for material in material_slots(node))
    for material in [*workspace.current().materials, *slots]:
        if material is not None and id(material) not in visited:
            visited.add(id(material))
            yield material
