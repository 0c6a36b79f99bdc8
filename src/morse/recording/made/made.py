"""An object that was spawned; scenes that are not recorded need only this."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.builder.assembly.spawning import Newcomer


class Made(NamedTuple):
    """An object that was spawned.

    Attributes:
        identity: another object for each spawned object, also of the same name.
        position, rotation: where it was spawned, m and rad.
        describe: returns the content of the object.
        kind: name of the kind; empty if a function created it.
    """

    identity: object
    position: Sequence[float]
    rotation: Sequence[float]
    describe: Callable[[], Newcomer]
    kind: str = ""
