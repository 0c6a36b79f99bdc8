"""Meshes, lamps, cameras and physics of objects under the names of Blender."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.assets.solids import polyhedron
from morse.builder import workspace
from morse.builder.errors import checks
from morse.builder.objects import NamedList, SceneObject, checked_property, material_slots, timer
from morse.builder.workspace import notice
from morse.mathutils import Vector
from morse.plugins.legacy.blender import Facade, Ignored, MaterialSlot, ObjectMaterial, SharedMaterial
from morse.scene import Bounds, Camera, NodeKind, PhysicsType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from morse.core.values import Properties, Value
    from morse.scene import Light, Node

_KINDS = {NodeKind.MESH: "MESH", NodeKind.LIGHT: "LAMP", NodeKind.CAMERA: "CAMERA", NodeKind.ARMATURE: "ARMATURE"}


def kind_of(node: Node) -> str:
    """The type of an object as Blender names it; the object of a camera sensor is a ``CAMERA``."""
    if "cam_far" in node.properties or "cam_focal" in node.properties or ".video_camera." in _classpath(node):
        return "CAMERA"
    return _KINDS.get(node.kind, "EMPTY")


def _classpath(node: Node) -> str:
    return str(node.properties.get("classpath", ""))


class _Materials(list[Any]):
    """The material slots of a mesh."""

    def __init__(self, node: Node) -> None:
        super().__init__(
            None if material is None else ObjectMaterial(node, index)
            for index, material in enumerate(material_slots(node))
        )
        self._node = node

    def _store(self) -> None:
        self._node.materials[:] = [None if item is None else item.read() for item in self]

    def append(self, material: object) -> None:
        _check(material)
        super().append(material)
        self._store()

    def __setitem__(self, key: Any, value: Any) -> None:
        for material in value if isinstance(key, slice) else [value]:
            _check(material)
        super().__setitem__(key, value)
        self._store()

    def clear(self, *_: object) -> None:
        super().clear()
        self._node.materials.clear()

    def pop(self, index: Any = -1, *_: object) -> Any:
        material = super().pop(index)
        self._store()
        return material


def _check(material: object) -> None:
    if not isinstance(material, (ObjectMaterial, SharedMaterial)):
        raise TypeError(f"a material such as bpy.data.materials.new('Red') is expected, got {checks.shown(material)}")


class MeshData(Facade):
    """The mesh of an object."""

    _path = "mesh"

    def __init__(self, node: Node) -> None:
        self._node = node

    @property
    def name(self) -> str:
        """Its name."""
        return self._node.mesh.name if self._node.mesh is not None else self._node.name

    @name.setter
    def name(self, value: str) -> None:
        checks.text(value, "mesh.name")

    @property
    def materials(self) -> list[Any]:
        """The material slots."""
        return _Materials(self._node)

    @property
    def vertices(self) -> list[Vertex]:
        """The vertices; copies."""
        return [Vertex(point) for point in self._points()]

    def size(self) -> Vector:
        """The size along each axis of the object, with its scale, m."""
        points = self._points()
        if not points:
            return Vector((0.0, 0.0, 0.0))
        axes = zip(*points, strict=True)
        return Vector([(max(a) - min(a)) * scale for a, scale in zip(axes, self._node.scale, strict=True)])

    def corners(self) -> list[Vector]:
        """The corners of the box around it, without a scale, m."""
        axes = [(min(a), max(a)) for a in zip(*self._points(), strict=True)] or [(0.0, 0.0)] * 3
        return [Vector((x, y, z)) for x in axes[0] for y in axes[1] for z in axes[2]]

    def _points(self) -> list[list[float]]:
        mesh = self._node.mesh
        return [] if mesh is None else [[float(x) for x in point] for point in mesh.vertices]

    def from_pydata(
        self, vertices: Iterable[Sequence[float]], edges: Iterable[Sequence[int]], faces: Iterable[Sequence[int]]
    ) -> None:
        """Replace the mesh: points, m, and convex faces as indices of points; edges have no effect."""
        points = [checks.triple(point, "from_pydata(vertices)") for point in vertices]
        corners = [tuple(int(corner) for corner in face) for face in faces]
        if any(not 0 <= corner < len(points) for face in corners for corner in face):
            raise ValueError(f"from_pydata(faces) takes indices of the {len(points)} vertices")
        self._node.mesh = polyhedron(self.name, points, corners)

    def update(self, *_args: object, **_kwargs: object) -> None:
        """Accepted for old scripts: there is nothing to compute."""

    validate = update

    def copy(self) -> MeshData:
        """The mesh itself: what a script changes of an object does not change others."""
        return self


class Vertex:
    """A vertex of a mesh."""

    __slots__ = ("co",)

    def __init__(self, point: Sequence[float]) -> None:
        self.co = Vector(point)


class LampData(Facade):
    """The lamp of an object."""

    _path = "lamp"

    def __init__(self, node: Node) -> None:
        self._node = node

    def _lamp(self) -> Light:
        assert self._node.light is not None
        return self._node.light

    @property
    def type(self) -> str:
        """POINT, SUN, SPOT, AREA or HEMI."""
        return self._lamp().type

    @type.setter
    def type(self, value: str) -> None:
        self._lamp().type = checks.choice(value, ("POINT", "SUN", "SPOT", "AREA", "HEMI"), "lamp.type")

    @property
    def color(self) -> tuple[float, float, float]:
        """Linear RGB, 0..1."""
        return self._lamp().color

    @color.setter
    def color(self, value: Iterable[float]) -> None:
        self._lamp().color = checks.color(value, "lamp.color")

    @property
    def energy(self) -> float:
        """Brightness; 1 is a normal lamp."""
        return self._lamp().energy

    @energy.setter
    def energy(self, value: float) -> None:
        self._lamp().energy = checks.number(value, "lamp.energy", minimum=0.0)

    @property
    def distance(self) -> float:
        """Distance at which the intensity has fallen to half, m."""
        return self._lamp().distance

    @distance.setter
    def distance(self, value: float) -> None:
        self._lamp().distance = checks.number(value, "lamp.distance", above=0.0)

    @property
    def spot_size(self) -> float:
        """Full opening angle of a spot, rad."""
        return self._lamp().spot_size

    @spot_size.setter
    def spot_size(self, value: float) -> None:
        self._lamp().spot_size = checks.number(value, "lamp.spot_size", above=0.0)


class CameraData(Facade):
    """The lens of a camera in the scene, or of a camera sensor: its ``cam_near``, ``cam_far`` and ``cam_focal``."""

    _path = "camera"

    def __init__(self, node: Node) -> None:
        self._node = node

    def _get(self, field: str, name: str) -> float:
        lens = self._node.camera or Camera()
        value = self._node.properties.get(name, getattr(lens, field))
        return float(value) if isinstance(value, (int, float, str)) else float(getattr(lens, field))

    def _set(self, field: str, name: str, value: object) -> None:
        number = checks.number(value, f"camera.{field}", above=0.0)
        if self._node.camera is not None:
            setattr(self._node.camera, field, number)
        else:
            self._node.properties[name] = number

    @property
    def clip_start(self) -> float:
        """Distance of the near plane, m."""
        return self._get("clip_start", "cam_near")

    @clip_start.setter
    def clip_start(self, value: float) -> None:
        self._set("clip_start", "cam_near", value)

    @property
    def clip_end(self) -> float:
        """Distance of the far plane, m."""
        return self._get("clip_end", "cam_far")

    @clip_end.setter
    def clip_end(self, value: float) -> None:
        self._set("clip_end", "cam_far", value)

    @property
    def lens(self) -> float:
        """Focal length, mm, for a sensor 32 mm wide."""
        return self._get("focal_length", "cam_focal")

    @lens.setter
    def lens(self, value: float) -> None:
        self._set("focal_length", "cam_focal", value)


def take_data(node: Node, block: MeshData | CameraData | LampData) -> None:
    """Give a node the mesh, lamp or lens of ``object.data``."""
    if not isinstance(block, (MeshData, CameraData, LampData)):
        raise TypeError(f"object.data takes a mesh, lamp or camera of bpy.data, got {checks.shown(block)}")
    source = block._node
    if source is not node:
        node.kind, node.mesh, node.light, node.camera = source.kind, source.mesh, source.light, source.camera
        node.materials, node.shapes = list(source.materials), None


#: the class of ``object.data`` by the type of the object
DATA: dict[str, Callable[[Node], MeshData | CameraData | LampData]] = {
    "MESH": MeshData,
    "LAMP": LampData,
    "CAMERA": CameraData,
}


_PHYSICS_TYPES = [kind.value for kind in PhysicsType if kind is not PhysicsType.AUTO]


#: settings of Blender's game engine that the physics of MORSE does not use
_NO_EFFECT_ON_GAMES = (
    "actuators",
    "collision_group",
    "collision_margin",
    "collision_mask",
    "controllers",
    "elasticity",
    "fall_speed",
    "form_factor",
    "friction_coefficients",
    "jump_speed",
    "obstacle_radius",
    "sensors",
    "show_actuators",
    "show_controllers",
    "show_debug_state",
    "show_sensors",
    "show_state_panel",
    "soft_body",
    "states_initial",
    "states_visible",
    "step_height",
    "use_activity_culling",
    "use_all_states",
    "use_anisotropic_friction",
    "use_material_physics_fh",
    "use_obstacle_create",
    "use_record_animation",
    "use_rotate_from_normal",
    "use_sleep",
    "velocity_max",
    "velocity_min",
)


def property_type(value: object) -> str:
    """The type of a property as Blender named it: BOOL, INT, FLOAT, STRING or TIMER."""
    if isinstance(value, timer):
        return "TIMER"
    if isinstance(value, bool):
        return "BOOL"
    if isinstance(value, int):
        return "INT"
    return "FLOAT" if isinstance(value, float) else "STRING"


class GameProperty:
    """A property of an object."""

    __slots__ = ("_properties", "name")

    def __init__(self, properties: Properties, name: str) -> None:
        self._properties = properties
        self.name = name

    @property
    def value(self) -> Value:
        """The value; its Python type is the type of the property."""
        return self._properties[self.name]

    @value.setter
    def value(self, value: object) -> None:
        self._properties[self.name] = checked_property(self.name, value)

    @property
    def type(self) -> str:
        """BOOL, INT, FLOAT, STRING or TIMER."""
        return property_type(self.value)


class _Number:
    """A numeric field of the body settings."""

    def __init__(self, field: str, *, above: float | None = None, maximum: float | None = None) -> None:
        self._field, self._above, self._maximum = field, above, maximum

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, settings: GameSettings, owner: type) -> float:
        return float(getattr(settings.node.body, self._field))

    def __set__(self, settings: GameSettings, value: float) -> None:
        number = checks.number(value, f"game.{self._name}", minimum=0.0, above=self._above)
        if self._maximum is not None and number > self._maximum:
            raise ValueError(f"game.{self._name} takes a number from 0 to {self._maximum:g}, got {number:g}")
        setattr(settings.node.body, self._field, number)


class _Flag:
    """A boolean field of the body settings."""

    def __init__(self, field: str) -> None:
        self._field = field

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, settings: GameSettings, owner: type) -> bool:
        return bool(getattr(settings.node.body, self._field))

    def __set__(self, settings: GameSettings, value: bool) -> None:
        setattr(settings.node.body, self._field, checks.boolean(value, f"game.{self._name}"))


class _AxisFlag:
    """A boolean field of the body settings for one axis."""

    def __init__(self, field: str, axis: int) -> None:
        self._field, self._axis = field, axis

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, settings: GameSettings, owner: type) -> bool:
        return bool(getattr(settings.node.body, self._field)[self._axis])

    def __set__(self, settings: GameSettings, value: bool) -> None:
        axes = list(getattr(settings.node.body, self._field))
        axes[self._axis] = checks.boolean(value, f"game.{self._name}")
        setattr(settings.node.body, self._field, tuple(axes))


class GameSettings:
    """Physics and properties of an object.

    Attributes:
        mass: kg.
        radius: radius of the sphere that represents a body without a mesh, m.
        damping: share of the linear velocity lost each second, 0..1.
        rotation_damping: share of the angular velocity lost each second, 0..1.
        use_actor: whether sensors detect it.
        use_ghost: whether contacts are reported without forces.
        use_collision_compound: the shapes of the children belong to this body.
        lock_location_x: the body cannot move along the X axis of the world (and so on).
        lock_rotation_x: the body cannot turn about the X axis of the world (and so on).
    """

    __slots__ = ("node",)

    def __init__(self, node: Node) -> None:
        self.node = node

    if not TYPE_CHECKING:  # lets type checkers find misspelt names

        def __getattr__(self, name: str) -> Any:
            if name not in _NO_EFFECT_ON_GAMES:
                checks.unknown_attribute(self, name)
            return Ignored(f"game.{name}")

    def __setattr__(self, name: str, value: object) -> None:
        if name in _NO_EFFECT_ON_GAMES:
            notice(f"game.{name} has no effect")
            return
        try:
            object.__setattr__(self, name, value)
        except AttributeError:
            checks.unknown_attribute(self, name)

    mass = _Number("mass", above=0.0)
    radius = _Number("radius", above=0.0)
    damping = _Number("linear_damping", maximum=1.0)
    rotation_damping = _Number("angular_damping", maximum=1.0)
    use_actor = _Flag("actor")
    use_ghost = _Flag("ghost")
    use_collision_compound = _Flag("compound")
    lock_location_x = _AxisFlag("lock_location", 0)
    lock_location_y = _AxisFlag("lock_location", 1)
    lock_location_z = _AxisFlag("lock_location", 2)
    lock_rotation_x = _AxisFlag("lock_rotation", 0)
    lock_rotation_y = _AxisFlag("lock_rotation", 1)
    lock_rotation_z = _AxisFlag("lock_rotation", 2)

    @property
    def physics_type(self) -> str:
        """STATIC, DYNAMIC, RIGID_BODY, NO_COLLISION, ..."""
        return self.node.body.type.value

    @physics_type.setter
    def physics_type(self, value: str) -> None:
        self.node.body.type = PhysicsType(checks.choice(value, _PHYSICS_TYPES, "game.physics_type"))

    @property
    def use_collision_bounds(self) -> bool:
        """Whether a chosen shape is used for collisions; False detects a shape from the mesh."""
        return self.node.body.bounds is not None

    @use_collision_bounds.setter
    def use_collision_bounds(self, value: bool) -> None:
        flag = checks.boolean(value, "game.use_collision_bounds")
        if flag != self.use_collision_bounds:
            self.node.body.bounds = Bounds.BOX if flag else None
            self.node.shapes = None

    @property
    def collision_bounds_type(self) -> str:
        """BOX, SPHERE, CYLINDER, CONE, CAPSULE, CONVEX_HULL or TRIANGLE_MESH."""
        return (self.node.body.bounds or Bounds.BOX).value

    @collision_bounds_type.setter
    def collision_bounds_type(self, value: str) -> None:
        self.node.body.bounds = Bounds(checks.choice(value, list(Bounds), "game.collision_bounds_type"))
        self.node.shapes = None

    @property
    def properties(self) -> NamedList[GameProperty]:
        """The properties, by name or in the order in which they were set."""
        own = self.node.properties
        return NamedList([GameProperty(own, name) for name in own], "property")


#: settings of objects in Blender that neither physics nor pictures of MORSE use
NO_EFFECT_ON_OBJECTS = (
    "animation_data", "animation_data_clear", "animation_data_create", "color", "constraints", "delta_location",
    "draw_bounds_type", "draw_type", "dupli_type", "empty_draw_size", "empty_draw_type", "field", "hide_select",
    "keyframe_insert", "layers", "lock_location", "lock_rotation", "lock_scale", "lod_levels", "modifiers",
    "parent_bone", "parent_type", "pass_index", "rotation_mode", "show_axis", "show_bounds", "show_name",
    "show_texture_space", "show_transparent", "show_wire", "show_x_ray", "track_axis", "up_axis", "update_tag",
    "vertex_groups",
)  # fmt: skip


class ObjectNames:
    """The attributes of an object of Blender that `SceneObject` does not have, for one node."""

    def __init__(self, node: Node) -> None:
        self.node = node

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

    @property
    def game(self) -> GameSettings:
        """Physics and properties."""
        return GameSettings(self.node)
