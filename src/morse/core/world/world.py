"""The running world, as components and services see it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, Self, TypeAlias, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from morse.core.values import StateData
    from morse.core.world.body import Bodies, Body, ContactMoment, JointMoment, Mounting
    from morse.scene import Bone, ComponentDeclaration, Node, Zone


_Q = TypeVar("_Q", contravariant=True)


class Server(Protocol[_Q]):
    """Answers requests of one kind."""

    def serve(self, requests: Sequence[_Q]) -> None:
        """Answer requests, all of which belong to this server, for the present state of the world."""


class Request(Protocol):
    """A query that must be answered before each action of a component; the server writes the answer into it."""

    @property
    def server(self) -> Server[Self]:
        """The server that answers the request."""


Hanging: TypeAlias = tuple["Body", int, "Sequence[float]", "Sequence[float]"]
"""An object, the index of its bone, and its position (3) and rotation (9) in the frame of the bone."""


class Linkage(Protocol):
    """The bones of an armature and the objects attached to them."""

    def move(self, values: Sequence[float]) -> None:
        """Move to joint values, rad or m: one for each bone that is not fixed, in the order of the bones."""


class WorldPoses(Protocol):
    """The poses of all rigid groups, and what has changed.

    Attributes:
        stamp: a value that changes whenever an object has moved.
        arrangement: a number that changes whenever objects are added, removed or replaced.
        displacements: number of changes of poses within a rigid group.
        relocated: the static groups that were moved by explicit calls.
        repaint_sinks: callbacks for objects whose appearance has changed.
    """

    stamp: int
    arrangement: int
    displacements: int
    relocated: set[int]
    repaint_sinks: list[Callable[[Body], object]]

    @property
    def positions(self) -> PoseTable:
        """The positions (K, 3) of the rigid groups, m: rows that are replaced, not changed."""

    @property
    def rotations(self) -> PoseTable:
        """The rotations (K, 9) of the rigid groups: rows that are replaced, not changed."""

    @property
    def layout(self) -> int:
        """A value that changes whenever `moving_nodes` changes."""

    def moving_nodes(self) -> list[tuple[Node, str]]:
        """Return the nodes whose poses change, each with its frame, ``world`` or ``parent``."""

    def snapshots(self, objects: Sequence[Body]) -> Snapshots:
        """Create a source of snapshots of the poses of some objects."""


class World(WorldPoses, Protocol):
    """All bodies, and the physics."""

    @property
    def physics_of_1_4(self) -> bool:
        """Whether robots are as slow as in the engine of MORSE 1.4."""

    def add(
        self,
        roots: Sequence[Node],
        components: Sequence[ComponentDeclaration] = (),
        carrier: Node | None = None,
    ) -> Sequence[Body]:
        """Add nodes, with all nodes below them, while the simulation runs.

        The model is recompiled. Existing bodies keep their state and their objects.

        Args:
            roots: nodes without a parent, with computed collision shapes; they are added at the end of the scene.
            components: the declarations of their components; the declarations of robots determine how they move.
            carrier: the node to which they are attached, with the same relative poses; None for the world.

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

    def reset(self, *, motors: bool = False) -> None:
        """Reset all objects to the scene, at rest.

        Args:
            motors: whether motors get the gains and the control modes of `keep_motors`; else they keep their own.
        """

    def keep_motors(self) -> None:
        """Take the present gains and control modes of motors for `reset`."""

    def step(self) -> None:
        """Run one tick: apply the commands, run the steps of the engine, read the poses."""

    def advance(self, ticks: int) -> int:
        """Run ticks with the commands for the next tick: several at once while robots only glide, or while only the
        engine moves bodies that nobody commands.

        Args:
            ticks: largest number, at least 1.

        Returns:
            The number of ticks, at least 1, with the bits of as many calls of `step`.
        """

    def fleet(self, objects: Sequence[Body]) -> Fleet:
        """Create a fleet of objects that are driven as bodies by one call."""

    def wheel_fleet(self, objects: Sequence[Body]) -> Fleet:
        """Create a fleet of robots whose wheels are turned by one call."""

    def kinematic_bodies(self, objects: Sequence[Body]) -> KinematicBodies:
        """Create what moves bodies of the type ``KINEMATIC`` by one call.

        Raises:
            ValueError: an object is no such body.
        """

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


class Sight(Protocol):
    """The results of a cast."""

    @property
    def distances(self) -> NDArray[np.float64]:
        """(N,) distance of each hit, m; infinite for no hit."""

    @property
    def ranges(self) -> NDArray[np.float64]:
        """(N,) distance of each hit, m; the reach for no hit."""

    @property
    def points(self) -> NDArray[np.float64]:
        """(N, 3) hit points in the frame of the sensor, m; [0, 0, 0] for no hit."""

    @property
    def hit(self) -> NDArray[np.int64]:
        """(N,) number of the solid at each hit; -1 for no hit; see `RayBundle.object_of`."""


class RayBundle(Sight, Protocol):
    """The rays of a sensor, and what they hit.

    Attributes:
        directions: (N, 3) unit vectors in the frame of the object; the array must not be modified.
        reach: largest distance of a hit, m.
    """

    directions: NDArray[np.float64]
    reach: float

    def __len__(self) -> int: ...

    @property
    def server(self) -> Server[Self]:
        """The server that casts these rays together with those of other sensors (see `morse.core.requests`)."""

    @property
    def sight(self) -> Sight:
        """The results of the last cast, which do not change."""

    def turn_to(self, directions: ArrayLike) -> None:
        """Set other directions: (N, 3) vectors of nonzero length, in the frame of the object."""

    def refresh(self) -> None:
        """Cast the rays now, unless no object has moved since the last cast."""

    @property
    def remissions(self) -> NDArray[np.float64]:
        """(N,) reflectance, 0..1: the ``specular`` of the material at each hit; 0 for no hit."""

    @property
    def normals(self) -> NDArray[np.float64]:
        """(N, 3) unit vectors perpendicular to the surface at each hit, on the side of the sensor; zeros for no hit.

        In the frame of the directions; read them in the tick of the cast, because they follow from the present poses.
        """

    @property
    def velocities(self) -> NDArray[np.float64]:
        """(N, 3) velocity over the ground of the surface at each hit, m/s; zeros for no hit.

        In the frame of the directions; read them in the tick of the cast, because they follow from the present motion.
        """

    def object_of(self, ray: int) -> Body | None:
        """Return the object that a ray has hit; None for no hit, or if the object has been removed since."""

    def segments(self) -> NDArray[np.float32]:
        """Return (N, 7) origin, end (m, world frame) and 1 for a hit, 0 for no hit."""


class Rays(Protocol):
    """Casts rays."""

    def bundle(
        self,
        obj: Body,
        directions: ArrayLike,
        reach: float,
        origins: ArrayLike | None = None,
        *,
        upright: bool = False,
    ) -> RayBundle:
        """Create the rays of a sensor.

        Args:
            obj: the object of the sensor.
            directions: (N, 3) vectors in its frame, of nonzero length.
            reach: largest distance, m; may be infinite.
            origins: (N, 3) m in its frame; None if all rays start at its origin.
            upright: directions and origins are given along the axes of the world, independent of the orientation of the
                sensor.

        Raises:
            ValueError: an array has the wrong shape or contains a value that is not finite, or the reach is not
                positive.
        """


class PoseTable(Protocol):
    """Rows of numbers, one for each rigid group, which are replaced and not changed."""

    def __len__(self) -> int: ...

    def __getitem__(self, index: int, /) -> Sequence[float]: ...

    def share(self) -> NDArray[np.float64]:
        """Return all present rows (K, D); the array does not change afterwards."""


class Snapshot(Protocol):
    """The poses of some objects at one moment.

    Attributes:
        slots: the rigid groups of the objects.
    """

    slots: Sequence[int]

    def pose(self, row: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the position (3) and rotation (9, row by row) of an object in the world."""

    def positions(self) -> NDArray[np.float64]:
        """Return the positions (N, 3) in the world, m."""

    def rotations(self) -> NDArray[np.float64]:
        """Return the rotations (N, 9) in the world, row by row."""

    @classmethod
    def poses_at(cls, moments: Sequence[Self]) -> tuple[Sequence[NDArray[np.float64]], Sequence[NDArray[np.float64]]]:
        """Return the poses (R, N) of the objects at several moments: 3 coordinates, 9 numbers of the rotations."""


class Fleet(Protocol):
    """Robots that one call drives."""

    def adopt(self, row: int) -> bool:
        """Make the present command of a robot last; return False if it has no command that can last."""

    def drive(self) -> None:
        """Drive all robots during the next tick."""


class KinematicBodies(Protocol):
    """Bodies of the type ``KINEMATIC``, which nothing but calls moves: people, doors, belts, cars."""

    def place(
        self,
        positions: NDArray[np.float64],
        quaternions: NDArray[np.float64],
        velocities: NDArray[np.float64] | None = None,
    ) -> None:
        """Set all poses.

        Args:
            positions: (N, 3) of the origins in the world, m.
            quaternions: (N, 4) w, x, y, z from the axes of the bodies to those of the world; they are normalised.
            velocities: (N, 3) that sensors of velocities measure until the next call, world axes, m/s; None for those
                of the last call, which are 0 at first.

        Raises:
            ValueError: an array has another shape, or a value is not finite or too large.
            LookupError: one of the bodies was removed from the world.
        """

    def move_surfaces(self, linear: NDArray[np.float64], angular: NDArray[np.float64]) -> None:
        """Let the surfaces move during the next tick, while the bodies stand still: friction carries what lies on them.

        Args:
            linear: (N, 3) velocities of the surfaces at the origins of the bodies, world axes, m/s.
            angular: (N, 3) angular velocities of the surfaces about these origins, world axes, rad/s.

        Raises:
            ValueError: an array has another shape, or a value is not finite or too large.
            LookupError: one of the bodies was removed from the world.
        """


class Snapshots(Protocol):
    """Takes snapshots of the same objects repeatedly, at little cost."""

    def place(self, row: int) -> tuple[int, Mounting]:
        """Return the group of an object, and its pose in the group."""

    def now(self) -> Snapshot:
        """Return a snapshot of the present poses."""

    def before(self) -> Snapshot:
        """Return a snapshot of the poses at the beginning of the last tick of `World.advance`."""
