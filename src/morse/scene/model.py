"""Records the model files of the nodes of a scene."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from morse.scene.node import Node

#: the use of the objects, which determines their physics if the file does not; a casing is the body of a sensor or
#: actuator and does not collide
Role = Literal["environment", "component", "casing", "prop"]


@dataclass(frozen=True, slots=True)
class Choice:
    """The selection of objects of a model file for a scene.

    Attributes:
        role: the use of the objects in the scene.
        whole: whether all objects are used, below one root.
        names: names of the objects, each used with all objects below it; None for no such choice.
        prefix: objects whose names begin with it, or the collection of that name; None for no such choice.
    """

    role: Role
    whole: bool = False
    names: tuple[str, ...] | None = None
    prefix: str | None = None


@dataclass(eq=False, slots=True)
class ModelUse:
    """Nodes that came from a model file, so that they can follow the file when it changes.

    Attributes:
        path: the file.
        nodes: the nodes in the scene, by their names in the file; a script may have changed, moved or deleted them.
        originals: copies of the same nodes with the values of the file.
    """

    path: str
    choice: Choice
    nodes: dict[str, Node] = field(default_factory=dict)
    originals: dict[str, Node] = field(default_factory=dict)
