"""What an object asks of its world, the world of a removed object, and lists of objects."""

from __future__ import annotations

import difflib
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Generic, NoReturn, Protocol, TypeVar, overload

from morse.physics.reactions import Reactions
from morse.physics.state.engine_state import EngineState

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from morse.mathutils import Vector
    from morse.physics.bodies import Bodies
    from morse.physics.driving.drives import Drives
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.objects.attachments import Attachments
    from morse.physics.objects.gameobject import GameObject
    from morse.physics.reactions import ContactMoment, JointMoment
    from morse.scene import Node


class ObjectWorld(EngineState):
    """The state of the engine, and the object of each node; see `morse.physics.world.World`.

    Attributes:
        bodies: sets poses, velocities and forces.
        drives: executes velocity commands.
        attachments: the held objects.
        gliding: moves driven robots.
    """

    bodies: Bodies
    drives: Drives
    attachments: Attachments
    gliding: Gliding

    @cached_property
    def _reactions(self) -> Reactions[GameObject]:
        return Reactions(self, self.find_object)

    def contact_moment(self, objects: Sequence[Posed]) -> ContactMoment[GameObject]:
        """See `morse.core.world.World.contact_moment`."""
        return self._reactions.take(self.gliding).contact_moment(objects)

    def joint_moment(self, objects: Sequence[Posed]) -> JointMoment:
        """See `morse.core.world.World.joint_moment`."""
        return self._reactions.take(self.gliding).joint_moment(objects)

    @abstractmethod
    def object_of(self, node: Node) -> GameObject:
        """The object of a node."""

    @abstractmethod
    def find_object(self, node: Node) -> GameObject | None:
        """Return the object of a node, or None if the node was removed from the world."""

    @property
    def is_stale(self) -> bool:
        """Whether an object was moved by an explicit call since the last forward kinematics of the engine."""
        return bool(self.touched or self.rearranged)

    def slot_poses(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return positions (K, 3) and rotations (K, 3, 3) of the slots with shapes, which must be read immediately."""
        return self.positions.array, self.rotations.array.reshape(-1, 3, 3)

    @abstractmethod
    def cast(
        self,
        start: Sequence[float],
        target: Sequence[float],
        distance: float,
        prop: str,
        xray: bool,
        exclude: GameObject,
    ) -> tuple[GameObject | None, Vector | None, Vector | None]:
        """See `GameObject.rayCast`; the ray ignores the body of ``exclude``."""

    @abstractmethod
    def note_displaced(self, obj: GameObject) -> None:
        """Record that a node has moved relative to its parent, so that the view gets its pose from now on."""

    @abstractmethod
    def appearance_changed(self, obj: Posed) -> None:
        """Notify the view that the appearance of an object changed."""


class Posed(Protocol):
    """An object with a pose in the world; see `morse.physics.objects.gameobject.GameObject`.

    Attributes:
        node: the node of the scene for this object.
        slot: index of the rigid group of the object.
    """

    node: Node
    slot: int

    def world_pose(self) -> tuple[Sequence[float], Sequence[float]]:
        """Position (3) and rotation (9, row-major) in the world."""


class RemovedError(LookupError):
    """An object was used that is no longer in the world."""


class RemovedWorld:
    """The world of a removed object; every access raises `RemovedError`."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, attribute: str) -> NoReturn:
        name = self.__dict__["_name"]
        raise RemovedError(f"'{name}' has been removed from the world")


class Named(Protocol):
    """An object with a name in the scene."""

    @property
    def name(self) -> str:
        """The name in the scene."""

    @property
    def node(self) -> Node:
        """The node of the scene for this object."""


T = TypeVar("T", bound=Named)
_D = TypeVar("_D")


class ObjectList(Sequence[T], Generic[T]):
    """A list of objects that can also be indexed by name.

    A name matches the name in the scene or the name in the model file: the second robot of a kind has a ``left_eye``,
    although its name in the scene is ``left_eye.001``.
    """

    def __init__(self, objects: list[T]) -> None:
        self._objects = objects

    def _named(self, name: str) -> T | None:
        exact = next((obj for obj in self._objects if obj.name == name), None)
        return exact or next((obj for obj in self._objects if obj.node.plain_name == name), None)

    @overload
    def __getitem__(self, key: int | str) -> T: ...
    @overload
    def __getitem__(self, key: slice) -> list[T]: ...
    def __getitem__(self, key: int | str | slice) -> T | list[T]:
        if not isinstance(key, str):
            return self._objects[key]
        found = self._named(key)
        if found is None:
            names = [obj.node.plain_name for obj in self._objects]
            close = difflib.get_close_matches(key, names, n=1)
            hint = f"did you mean '{close[0]}'?" if close else f"there are: {', '.join(names) or 'none'}"
            raise KeyError(f"there is no object '{key}'; {hint}")
        return found

    def __contains__(self, key: object) -> bool:
        return self._named(key) is not None if isinstance(key, str) else key in self._objects

    def __len__(self) -> int:
        return len(self._objects)

    def __iter__(self) -> Iterator[T]:
        return iter(self._objects)

    def get(self, name: str, default: _D | None = None) -> T | _D | None:
        """Return the object of that name, or ``default``."""
        return self._named(name) or default

    def keys(self) -> list[str]:
        """Return the names."""
        return [obj.name for obj in self._objects]

    def __repr__(self) -> str:
        return repr([obj.name for obj in self._objects])
