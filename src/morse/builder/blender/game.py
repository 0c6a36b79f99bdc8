"""Physics settings and properties of a node under the names of Blender's game engine."""

from __future__ import annotations

import math
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any

from morse.builder.blender.named import NamedList
from morse.builder.errors import checks
from morse.builder.errors.attributes import unknown_attribute
from morse.builder.legacy.ignored import Ignored
from morse.builder.legacy.notices import notice
from morse.scene import Bounds, PhysicsType

if TYPE_CHECKING:
    from morse.core.values import Properties, Value
    from morse.scene import Node

_PHYSICS_TYPES = [kind.value for kind in PhysicsType if kind is not PhysicsType.AUTO]


#: settings of Blender's game engine that the physics of MORSE does not use
_WITHOUT_EFFECT = (
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


class timer(float):  # noqa: N801 (scripts of 1.4 write it so)
    """A property that counts seconds."""


def property_type(value: object) -> str:
    """The type of a property as Blender named it: BOOL, INT, FLOAT, STRING or TIMER."""
    if isinstance(value, timer):
        return "TIMER"
    if isinstance(value, bool):
        return "BOOL"
    if isinstance(value, int):
        return "INT"
    return "FLOAT" if isinstance(value, float) else "STRING"


def checked_property(name: str, value: object) -> object:
    """Return the value of a property as it is stored; numpy scalars are converted to Python scalars.

    Raises:
        ValueError: NaN.
    """
    if isinstance(value, Real) and not isinstance(value, (bool, int, float)):
        value = int(value) if isinstance(value, Integral) else float(value)
    if isinstance(value, float) and math.isnan(value):
        raise ValueError(f"property '{name}' takes a number, got NaN")
    return value


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
            if name not in _WITHOUT_EFFECT:
                unknown_attribute(self, name)
            return Ignored(f"game.{name}")

    def __setattr__(self, name: str, value: object) -> None:
        if name in _WITHOUT_EFFECT:
            notice(f"game.{name} has no effect")
            return
        try:
            object.__setattr__(self, name, value)
        except AttributeError:
            unknown_attribute(self, name)

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
