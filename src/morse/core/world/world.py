"""The running world, as components and services see it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

from morse.core.world.poses import WorldPoses

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from morse.core.values import StateData
    from morse.core.world.body import Bodies, Body, ContactMoment, JointMoment
    from morse.core.world.linkage import Hanging, Linkage
    from morse.core.world.rays import Rays
    from morse.core.world.snapshots import Fleet
    from morse.scene import Bone, ComponentDeclaration, Node, Zone


class World(WorldPoses, Protocol):
    """All bodies, and the physics."""

    @property
    def physics_of_1_4(self) -> bool:
        """Whether robots are as slow as in the engine of MORSE 1.4."""

    def add(self, roots: Sequence[Node], components: Sequence[ComponentDeclaration] = ()) -> Sequence[Body]:
        """Add nodes, with all nodes below them, while the simulation runs.

        The model is recompiled. Existing bodies keep their state and their objects.

        Args:
            roots: nodes without a parent, with computed collision shapes; they are added at the end of the scene.
            components: the declarations of their components; the declarations of robots determine how they move.

        Returns:
            The objects of all added nodes.

        Raises:
            ValueError: a name already exists, or the engine refuses a shape; the world is then unchanged.
        """

    def remove(self, objects: Sequence[Body]) -> None:
        """Remove objects, with all objects below them; objects that were attached with `setParent` are detached.

        A removed object raises `RemovedError` when it is used.
        """

    def renew(self, objects: Sequence[Body]) -> None:
        """Start objects again as in the scene, with all objects below them; the others keep their state.

        The model is recompiled.
        """

    def arrange(self, roots: Sequence[Node], components: Sequence[ComponentDeclaration], zones: Sequence[Zone]) -> None:
        """Set the nodes of the world to exactly these, in this order; existing objects keep their state.

        Raises:
            ValueError: the engine refuses a shape; the world is then unchanged.
        """

    @property
    def objects_by_name(self) -> Mapping[str, Body]:
        """All objects of the world by name."""

    def objects(self) -> Iterator[Body]:
        """Iterate over all objects, parents before their children."""

    def object_list(self) -> Bodies:
        """All objects, indexed by number or by name."""

    def object_of(self, node: Node) -> Body:
        """The object of a node."""

    def find_object(self, node: Node) -> Body | None:
        """Return the object of a node, or None if the node was removed from the world."""

    def reset(self) -> None:
        """Reset all objects to the scene, at rest; motors keep their control modes."""

    def step(self) -> None:
        """Run one tick: apply the commands, run the steps of the engine, read the poses."""

    def step_freely(self, ticks: int) -> int:
        """Run at most that many ticks in which robots only glide, or only the engine moves bodies that nobody commands.

        The commands are those for the next tick.

        Returns:
            The number of ticks, with the bits of as many calls of `step`; 0 if the next tick needs more than that.
        """

    def fleet(self, objects: Sequence[Body]) -> Fleet:
        """Create a fleet of objects that are driven as bodies by one call."""

    def wheel_fleet(self, objects: Sequence[Body]) -> Fleet:
        """Create a fleet of robots whose wheels are turned by one call."""

    def linkage(self, armature: Body, bones: Sequence[Bone], hanging: Sequence[Hanging]) -> Linkage:
        """Create a linkage: objects on bones that joints move."""

    @property
    def rays(self) -> Rays:
        """The ray caster, created on demand."""

    def is_fixed(self, slot: int) -> bool:
        """Whether a slot is static, apart from explicit calls."""

    def contacts(self) -> Sequence[tuple[Body, Body]]:
        """Return the pairs of objects that are in contact."""

    def contact_moment(self, objects: Sequence[Body]) -> ContactMoment:
        """Return the present contacts of some bodies, whose forces may be computed later."""

    def joint_moment(self, objects: Sequence[Body]) -> JointMoment:
        """Return the present loads of the joints that carry some bodies, which may be computed later."""

    def touched_by(self, obj: Body, margin: float = 0.0) -> Sequence[Body]:
        """Return the objects whose shapes are closer than ``margin`` (m) to the shapes of an object, see `Touching`."""

    def set_mass(self, obj: Body, mass: float) -> None:
        """Set the mass of a body that moves freely, kg; its inertia changes in proportion. `reset` restores it.

        Raises:
            ValueError: it is no such body, or the mass differs by more than 10,000 from that of the scene.
        """

    def set_friction(self, obj: Body, friction: float) -> None:
        """Set the coefficient of sliding friction of all shapes of a body. `reset` restores those of the scene.

        Raises:
            ValueError: it is not a number from 0 to 100, or the body has no shapes.
        """

    def check_variation(self, obj: Body, what: str, value: float) -> None:
        """Raise the ValueError of `set_mass` or `set_friction`; ``what`` is ``mass`` or ``friction``."""

    def watch_touches(self, name: str) -> Mapping[str, float]:
        """Return what a body touches besides the floor, in the last tick: name of the other body to the impulse, N s.

        The mapping is always the same object, which each tick changes.
        """

    def contact_forces(self) -> bytes:
        """Return all contact points as bytes of (N, 6) float32, see `ContactPoints.look`."""

    def mass_centres(self) -> list[tuple[str, float, tuple[float, float, float]]]:
        """Return the name, mass (kg) and centre of mass (m, in its own frame) of every dynamic body."""

    def appearance_changed(self, obj: Body) -> None:
        """Notify the view that the appearance of an object changed."""

    def get_state(self) -> StateData:
        """Return the state that determines the future of the physics, as plain data that shares nothing with the world.

        Two worlds of the same scene with equal states continue identically, bit for bit, with the same inputs.
        """

    def check_state(self, state: object) -> None:
        """Raise `ValueError` if `set_state` would refuse the state."""

    def set_state(self, state: object) -> None:
        """Restore a state that `get_state` returned, of this world or of another world of the same scene.

        Raises:
            ValueError: the state is damaged, or belongs to another scene; the world is then unchanged.
        """
