"""What objects and rays see of the world that they are in."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING

from morse.physics.engine_state import EngineState

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.mathutils import Vector
    from morse.physics.attachments import Attachments
    from morse.physics.bodies import Bodies
    from morse.physics.drives import Drives
    from morse.physics.gameobject import GameObject
    from morse.scene import Node


class ObjectWorld(EngineState):
    """The state of the engine, and the object of each node; see `morse.physics.world.World`.

    Attributes:
        bodies: puts them somewhere, and gives them velocities and forces.
        drives: carries out velocity commands.
        attachments: what is held.
    """

    bodies: Bodies
    drives: Drives
    attachments: Attachments

    @abstractmethod
    def object_of(self, node: Node) -> GameObject:
        """The object of a node."""

    @abstractmethod
    def find_object(self, node: Node) -> GameObject | None:
        """The object of a node, or None if the node is not in the world any more."""

    @abstractmethod
    def slot_poses(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Positions (K, 3) and rotations (K, 3, 3) of the slots with shapes, to be read at once."""

    @property
    @abstractmethod
    def is_stale(self) -> bool:
        """Whether something was put elsewhere since the engine last worked out where everything is."""

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
        """See `GameObject.rayCast`; the body of ``exclude`` is looked through."""

    @abstractmethod
    def note_displaced(self, obj: GameObject) -> None:
        """A node has moved relative to its parent: from now on the view gets its pose."""

    @abstractmethod
    def appearance_changed(self, obj: GameObject) -> None:
        """Something about the looks of an object changed: the view has to know."""
