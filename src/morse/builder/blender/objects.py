"""The nodes of a scene under the names of Blender's objects, for scripts that know them.

``robot._bpy_object`` and ``bpymorse.get_object(name)`` are such objects. They have no data of their own: the node is
read and written.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.builder import workspace
from morse.builder.blender.datablocks import DATA, MeshData, kind_of, take_data
from morse.builder.blender.game import GameSettings, checked_property
from morse.builder.blender.materials import MaterialSlot, ObjectMaterial, SharedMaterial, material_slots
from morse.builder.blender.named import NamedList
from morse.builder.blender.pose import LiveEuler, LiveVector
from morse.builder.errors import checks
from morse.builder.errors.angles import hint_at_radians
from morse.builder.errors.attributes import unknown_attribute
from morse.builder.legacy.ignored import Ignored
from morse.builder.legacy.notices import notice

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.blender.datablocks import CameraData, LampData
    from morse.core.values import Value
    from morse.mathutils import Matrix, Vector
    from morse.scene import Node


#: settings of objects in Blender that neither physics nor pictures of MORSE use
_WITHOUT_EFFECT = (
    "animation_data", "animation_data_clear", "animation_data_create", "color", "constraints", "delta_location",
    "draw_bounds_type", "draw_type", "dupli_type", "empty_draw_size", "empty_draw_type", "field", "hide_select",
    "keyframe_insert", "layers", "lock_location", "lock_rotation", "lock_scale", "lod_levels", "modifiers",
    "parent_bone", "parent_type", "pass_index", "rotation_mode", "show_axis", "show_bounds", "show_name",
    "show_texture_space", "show_transparent", "show_wire", "show_x_ray", "track_axis", "up_axis", "update_tag",
    "vertex_groups",
)  # fmt: skip


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

        def __getattr__(self, name: str) -> Any:
            if name not in _WITHOUT_EFFECT:
                unknown_attribute(self, name)
            return Ignored(f"object.{name}")

        def __setattr__(self, name: str, value: object) -> None:
            if name in _WITHOUT_EFFECT:
                notice(f"object.{name} has no effect")
                return
            try:
                object.__setattr__(self, name, value)
            except AttributeError:
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
    def type(self) -> str:
        """MESH, EMPTY, LAMP, CAMERA or ARMATURE."""
        return kind_of(self.node)

    @property
    def data(self) -> MeshData | CameraData | LampData | None:
        """The mesh, lamp or camera; None for an object without one."""
        block = DATA.get(self.type)
        return None if block is None else block(self.node)

    @data.setter
    def data(self, block: MeshData | CameraData | LampData) -> None:
        take_data(self.node, block)

    def copy(self) -> SceneObject:
        """A copy in the same place, without the objects below it."""
        return SceneObject(workspace.current().duplicate(self.node))

    @property
    def bound_box(self) -> list[Vector]:
        """The eight corners of the box around its mesh, in its own frame without its scale, m."""
        return MeshData(self.node).corners()

    @property
    def active_material(self) -> ObjectMaterial | None:
        """The material of its first surface."""
        slots = self.material_slots
        return slots[0].material if slots else None

    @active_material.setter
    def active_material(self, material: ObjectMaterial | SharedMaterial) -> None:
        MeshData(self.node).materials[:1] = [material]

    @property
    def matrix_world(self) -> Matrix:
        """Pose and scale in the world, 4x4; a copy."""
        return self.node.world_matrix()

    @property
    def matrix_local(self) -> Matrix:
        """Pose and scale in the frame of the parent, 4x4; a copy."""
        return self.node.basis_matrix()

    @property
    def dimensions(self) -> Vector:
        """Size of its mesh along each axis of the object, m."""
        return MeshData(self.node).size()

    @dimensions.setter
    def dimensions(self, value: Iterable[float]) -> None:
        size = checks.triple(value, "dimensions")
        for axis, (length, now) in enumerate(zip(size, self.dimensions, strict=True)):
            if now > 0.0:
                self.node.scale[axis] *= length / now

    @property
    def hide(self) -> bool:
        """Whether it is invisible."""
        return not self.node.visible

    @hide.setter
    def hide(self, value: bool) -> None:
        self.node.visible = not checks.boolean(value, "hide")

    hide_render = hide
    hide_viewport = hide

    @property
    def select(self) -> bool:
        """Whether it is selected."""
        return self.node in workspace.current().selection

    @select.setter
    def select(self, value: bool) -> None:
        selection = workspace.current().selection
        if checks.boolean(value, "select") != (self.node in selection):
            (selection.append if value else selection.remove)(self.node)

    def __getitem__(self, name: str) -> Value:
        return self.node.properties[name]

    def __setitem__(self, name: str, value: object) -> None:
        self.node.properties[name] = checked_property(name, value)

    def __contains__(self, name: str) -> bool:
        return name in self.node.properties

    def get(self, name: str, default: object = None) -> Value:
        """The value of a property, or ``default``."""
        return self.node.properties.get(name, default)

    @property
    def game(self) -> GameSettings:
        """Physics and properties."""
        return GameSettings(self.node)
