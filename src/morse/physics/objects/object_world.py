"""The interface of the world for objects and rays."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property
from typing import TYPE_CHECKING

from morse.physics.reactions import Reactions
from morse.physics.state.engine_state import EngineState

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.mathutils import Vector
    from morse.physics.bodies import Bodies
    from morse.physics.driving.drives import Drives
    from morse.physics.gliding.gliding import Gliding
    from morse.physics.objects.attachments import Attachments
    from morse.physics.objects.gameobject import GameObject
    from morse.physics.objects.posed import Posed
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
