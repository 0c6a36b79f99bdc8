"""Materials under the names of Blender, and what MORSE does not have of it."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from morse.builder import workspace
from morse.builder.errors import checks
from morse.builder.objects import material_slots
from morse.builder.workspace import notice

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.scene import Material, Node


class Ignored:
    """Stands for a part of Blender that MORSE does not have: it can be used in any way, without effect.

    It is empty, false, and zero. The log names it once for each line of the script.

    Args:
        path: its name, e.g. ``bpy.context.user_preferences``.
        said: whether the log has named it already.
    """

    _path: str

    def __init__(self, path: str, *, silent: bool = False) -> None:
        object.__setattr__(self, "_path", path)
        if not silent:
            notice(f"{path} has no effect: MORSE does not have it")

    def __repr__(self) -> str:
        return f"<{self._path}>"

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Ignored:
            if name.startswith("__"):
                raise AttributeError(name)
            return Ignored(f"{self._path}.{name}", silent=True)

    def __setattr__(self, name: str, value: object) -> None:
        pass

    def __call__(self, *args: object, **kwargs: object) -> Ignored:
        """Another ignored value."""
        return Ignored(f"{self._path}()", silent=True)

    def __getitem__(self, key: object) -> Ignored:
        return Ignored(f"{self._path}[{key!r}]", silent=True)

    def __setitem__(self, key: object, value: object) -> None:
        pass

    def __iter__(self) -> Iterator[Any]:
        return iter(())

    def __len__(self) -> int:
        return 0

    def __contains__(self, item: object) -> bool:
        return False

    def _false(self, _other: object) -> bool:
        return False

    __lt__ = __le__ = __gt__ = __ge__ = _false

    def _other(self, other: object) -> object:
        return other

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __matmul__ = __truediv__ = __rtruediv__ = _other

    def __float__(self) -> float:
        return 0.0

    def __int__(self) -> int:
        return 0

    __index__ = __int__

    def __enter__(self) -> tuple[Ignored, Ignored]:
        # ``with bpy.data.libraries.load(path) as (source, target)``
        return self, self

    def __exit__(self, *error: object) -> None:
        pass


class Facade:
    """Some settings of MORSE under Blender's names: the properties of a subclass; all other names are ignored.

    Attributes:
        _path: its name in messages.
    """

    _path = "bpy"

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Ignored:
            if name.startswith("__"):
                raise AttributeError(name)
            return Ignored(f"{self._path}.{name}")

    def __setattr__(self, name: str, value: object) -> None:
        if hasattr(type(self), name) or name.startswith("_"):
            object.__setattr__(self, name, value)
        else:
            notice(f"{self._path}.{name} has no effect: MORSE does not have it")


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
_NO_EFFECT_ON_MATERIALS = (
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
            if name not in _NO_EFFECT_ON_MATERIALS:
                checks.unknown_attribute(self, name)
            return Ignored(f"material.{name}")

    def __setattr__(self, name: str, value: object) -> None:
        if name in _NO_EFFECT_ON_MATERIALS:
            notice(f"material.{name} has no effect")
        elif name.startswith("_") or hasattr(type(self), name):
            object.__setattr__(self, name, value)
        else:
            checks.unknown_attribute(self, name)

    def read(self) -> Material:
        """The material as the scene has it."""
        raise NotImplementedError

    def _write(self, **changes: object) -> None:
        raise NotImplementedError

    def copy(self) -> SharedMaterial:
        """A material with the same settings, which no object has yet; its name is unique."""
        names = {material.name for material in all_materials()}
        numbered = (f"{self.name}.{number:03d}" for number in itertools.count(1))
        name = next(name for name in numbered if name not in names)
        material = replace(self.read(), name=name)
        workspace.current().materials.append(material)
        return SharedMaterial(material)

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
