"""The physics of robots, objects and solids, as scripts set it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.assets.body_settings import COLLISIONS
from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.errors import checks
from morse.core.exceptions import MorseBuilderError
from morse.scene import PhysicsType

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from morse.core.values import Value
    from morse.scene import Node


def set_collision(nodes: Iterable[Node], value: object, what: str) -> None:
    """Let the meshes among nodes that collide have collision shapes of one kind.

    Args:
        value: a key of `COLLISIONS`.
        what: the argument, for messages.

    Raises:
        TypeError: the value is not a string.
        ValueError: there is no such kind.
    """
    bounds = COLLISIONS[checks.choice(value, [name for name, kind in COLLISIONS.items() if kind], what)]
    for node in nodes:
        if node.mesh is not None and node.shapes is None and (node.body.collides or node.body.ghost):
            node.body.bounds = bounds


COMMON_TYPES = ("STATIC", "RIGID_BODY", "DYNAMIC", "NO_COLLISION", "SENSOR")
"""The physics types that pages and clients may give to an object."""

_PHYSICS_TYPES = [kind.value for kind in PhysicsType if kind is not PhysicsType.AUTO]

#: physics settings that model files have as properties, and the methods of scripts
_METHODS = {
    "physics_type": "set_physics_type()",
    "collision": "the argument collision=",
    "mass": "set_mass()",
    "friction": "set_friction()",
    "restitution": "set_restitution()",
    "linear_damping": "set_damping()",
    "angular_damping": "set_damping()",
}


class Matter(AbstractComponent):
    """An object with physics."""

    def properties(self, **kwargs: Value) -> None:
        """Set properties: parameters of the component, or tags that other components use.

        A property that the component does not declare is kept, with a warning.

        Raises:
            MorseBuilderError: the name is one of the physics settings of a model file, which have methods here.
        """
        for name in kwargs.keys() & _METHODS.keys():
            raise MorseBuilderError(
                f"properties({name}=...) has no effect on the physics of '{self.name}': use {_METHODS[name]}"
            )
        super().properties(**kwargs)

    def set_physics_type(self, physics_type: str = "STATIC") -> None:
        """Set the physics type of the body.

        Args:
            physics_type: ``STATIC`` (fixed; other bodies collide with it), ``RIGID_BODY``, ``DYNAMIC`` (does not
                rotate), ``NO_COLLISION``, ``SENSOR``, ...
        """
        word = checks.choice(physics_type, _PHYSICS_TYPES, "set_physics_type(physics_type)")
        self.scene_node.body.type = PhysicsType(word)

    def set_rigid_body(self) -> None:
        """Make it a rigid body that moves and rotates under forces."""
        self.set_physics_type("RIGID_BODY")
        self.scene_node.body.actor = True

    def set_dynamic(self) -> None:
        """Make it a dynamic body that forces move, but do not rotate."""
        self.set_physics_type("DYNAMIC")
        self.scene_node.body.actor = True

    def set_no_collision(self) -> None:
        """Disable collisions and forces."""
        for node in self.own_nodes():
            node.body.type = PhysicsType.NO_COLLISION

    def static(self) -> None:
        """Fix the object: other bodies collide with it and do not move it."""
        for node in self._solid_nodes():
            node.body.type = PhysicsType.STATIC

    def _solid_nodes(self) -> Iterator[Node]:
        """The nodes that bodies collide with when it is static."""
        return (node for node in self.own_nodes() if node.body.moves)

    def set_mass(self, mass: float) -> None:
        """Set the mass of the body, kg."""
        self.scene_node.body.mass = checks.number(mass, "set_mass(mass)", above=0.0)

    def set_friction(self, friction: float = 0.0) -> None:
        """Set the Coulomb friction coefficient of all contacts."""
        coefficient = checks.number(friction, "set_friction(friction)", minimum=0.0)
        for node in self.own_nodes():
            node.body.friction = coefficient

    def set_restitution(self, restitution: float) -> None:
        """Set the elasticity of impacts, from 0 to 1: the ratio of the speeds after and before an impact."""
        ratio = checks.share(restitution, "set_restitution(restitution)")
        for node in self.own_nodes():
            node.body.restitution = ratio

    def set_damping(self, linear: float = 0.0, angular: float = 0.0) -> None:
        """Set the shares of the linear and the angular velocity that the body loses per second, from 0 to 1."""
        body = self.scene_node.body
        body.linear_damping = checks.share(linear, "set_damping(linear)")
        body.angular_damping = checks.share(angular, "set_damping(angular)")
