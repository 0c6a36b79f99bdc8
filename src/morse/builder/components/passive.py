"""Passive objects and zones."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Any, NoReturn

from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.components.collision import set_collision
from morse.builder.components.component import new_object
from morse.builder.errors import checks
from morse.core.exceptions import MorseBuilderError
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.blender.pose import LiveVector

logger = logging.getLogger(__name__)

#: physics settings that model files have as properties, and the methods of scripts
_PHYSICS = {
    "physics_type": "static()",
    "collision": "PassiveObject(collision=...)",
    "mass": "set_mass()",
    "friction": "set_friction()",
    "restitution": "set_restitution()",
    "linear_damping": "set_damping()",
    "angular_damping": "set_damping()",
}


class PassiveObject(AbstractComponent):
    """Objects from a model file.

    Args:
        filename: name of the model, e.g. ``props/objects`` (see `morse.assets.find`).
        prefix: only objects whose names begin with it, or the collection of that name; None for all.
        keep_pose: whether to keep the pose of the first object in the file; otherwise it is moved to the origin.
        object_name: only the object with this name, and those below it; instead of ``prefix``.
        collision: collision shapes of its meshes: ``hull`` (the convex hull of each), ``decompose`` (at most 32 convex
            parts, by `CoACD <https://github.com/SarahWeiii/CoACD>`_ if it is installed), ``mesh`` (exact), ``box``,
            ``sphere``, ``cylinder``, ``cone``, ``capsule``. By default, objects that move have exact shapes if 32 are
            enough, otherwise an approximation by so many, and static ones have exact shapes.

    Raises:
        FileNotFoundError: there is no such model.
        MorseBuilderNoComponentError: no object in the model has such a name.
    """

    def __init__(
        self,
        filename: str = "props/objects",
        prefix: str | None = None,
        keep_pose: bool = False,
        object_name: str | None = None,
        *,
        collision: str | None = None,
    ) -> None:
        super().__init__(filename=checks.text(filename, "PassiveObject(filename)"))
        if prefix is not None:
            checks.text(prefix, "PassiveObject(prefix)")
        names = None if object_name is None else [checks.text(object_name, "PassiveObject(object_name)")]
        self.set_blender_object(self.append_meshes(names, prefix=prefix)[0])
        if collision is not None:
            set_collision(self.own_nodes(), collision, "PassiveObject(collision)")
        if not checks.boolean(keep_pose, "PassiveObject(keep_pose)"):
            self.scene_node.parent_inverse = None
            self.location = (0.0, 0.0, 0.0)
            self.rotation_euler = (0.0, 0.0, 0.0)

    def properties(self, **kwargs: Any) -> None:
        """Set tags that components use.

        Raises:
            MorseBuilderError: the name is one of the physics settings of a model file, which have methods here.
        """
        for name in kwargs.keys() & _PHYSICS.keys():
            raise MorseBuilderError(
                f"properties({name}=...) has no effect on the physics of '{self.name}': use {_PHYSICS[name]}"
            )
        super().properties(**kwargs)

    # --- physics ----------------------------------------------------------------------------

    def static(self) -> None:
        """Fix the object: other bodies collide with it and do not move it."""
        for node in self.own_nodes():
            if node.body.moves:
                node.body.type = PhysicsType.STATIC

    def set_mass(self, mass: float) -> None:
        """Set the mass, kg."""
        self.scene_node.body.mass = checks.number(mass, "set_mass(mass)", above=0.0)

    def set_friction(self, friction: float) -> None:
        """Set the Coulomb friction coefficient of all contacts."""
        coefficient = checks.number(friction, "set_friction(friction)", minimum=0.0)
        for node in self.own_nodes():
            node.body.friction = coefficient

    def set_restitution(self, restitution: float) -> None:
        """Set the elasticity of impacts, from 0 to 1: the ratio of the speeds after and before an impact."""
        for node in self.own_nodes():
            node.body.restitution = _share(restitution, "set_restitution(restitution)")

    def set_damping(self, linear: float = 0.0, angular: float = 0.0) -> None:
        """Set the shares of the linear and the angular velocity that the object loses per second, from 0 to 1."""
        body = self.scene_node.body
        body.linear_damping = _share(linear, "set_damping(linear)")
        body.angular_damping = _share(angular, "set_damping(angular)")

    def setgraspable(self) -> None:
        """Allow robots to grasp it, and cameras to recognise it, under its present name."""
        self.properties(Object=True, Graspable=True, Label=self.name)


def _share(value: float, what: str) -> float:
    share = checks.number(value, what, minimum=0.0)
    if share > 1.0:
        raise ValueError(f"{what} takes a number from 0 to 1, got {share:g}")
    return share


class Zone(AbstractComponent):
    """An invisible axis-aligned box with a type, e.g. for charging batteries.

    Args:
        type: type of the zone, e.g. ``Charging``.
    """

    def __init__(self, type: str) -> None:
        super().__init__()
        self.type = checks.text(type, "Zone(type)")
        self.set_blender_object(new_object("Zone"))
        self.scene_node.visible = False
        self.properties(Zone_Tag=True, Type=self.type)

    @property
    def size(self) -> LiveVector:
        """Half extent along each axis, m."""
        return self.scale

    @size.setter
    def size(self, value: Iterable[float]) -> None:
        extents = checks.triple(value, "Zone.size")
        if min(extents) <= 0.0:
            raise ValueError(f"Zone.size takes three half extents greater than 0, got {checks.shown(extents)}")
        self.scale = extents

    def rotate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> NoReturn:
        """Raise an error, because zones are axis-aligned.

        Raises:
            MorseBuilderError: always.
        """
        raise MorseBuilderError(
            "a Zone cannot be rotated: its sides follow the axes of the world; set its size instead"
        )
