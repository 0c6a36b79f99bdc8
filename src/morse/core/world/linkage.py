"""Objects on the bones of an armature, as components see them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.world.body import Body

Hanging: TypeAlias = tuple["Body", int, "Sequence[float]", "Sequence[float]"]
"""An object, the index of its bone, and its position (3) and rotation (9) in the frame of the bone."""


class Linkage(Protocol):
    """The bones of an armature and the objects attached to them."""

    def move(self, values: Sequence[float]) -> None:
        """Move to joint values, rad or m: one for each bone that is not fixed, in the order of the bones."""
