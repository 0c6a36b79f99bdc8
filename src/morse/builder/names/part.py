"""The protocol of scene objects that can be named."""

from __future__ import annotations

import re
from enum import IntEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.scene import Node, SourceLine

_COPY_SUFFIX = re.compile(r"\.\d{3,}$")


class Strength(IntEnum):
    """The source of a name, weakest first."""

    NONE = 0
    GUESSED = 1
    VARIABLE = 2
    GIVEN = 3


class Part:
    """A component or an object of a scene that is being described: `AbstractComponent` without its methods.

    Attributes:
        basename: its name without the names of its parents, or None until it has a name.
        name_strength: source of ``basename``.
        _where: the line of the script that created it.
    """

    basename: str | None
    name_strength: Strength
    _where: SourceLine | None

    if TYPE_CHECKING:

        @property
        def parent(self) -> Part | None:
            """The component that it is part of."""

        @property
        def children(self) -> Sequence[Part]:
            """The components that are part of it."""

        @property
        def name(self) -> str:
            """The name in the scene."""

        @property
        def scene_node(self) -> Node:
            """The node of the scene."""

        @property
        def is_complete(self) -> bool:
            """Whether it has an object of the scene."""

        @property
        def is_robot(self) -> bool:
            """Whether it can carry sensors and actuators."""

    @property
    def plain_name(self) -> str:
        """Its own name, without the names of its parents."""
        return self.basename or without_copy_suffix(self.scene_node.name)

    def suggest_name(self, name: str, strength: Strength) -> None:
        """Set the name, unless it has a name from a stronger source."""
        if strength > self.name_strength:
            self.basename = name
            self.name_strength = strength


def without_copy_suffix(name: str) -> str:
    """The name of an object as the name of a component: ``morsy`` for ``morsy.001``, without dots and spaces."""
    return "_".join(_COPY_SUFFIX.sub("", name).replace(".", "_").split())
