"""Passive objects and zones."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from morse.builder.abstractcomponent import AbstractComponent
from morse.builder.components.component import new_object
from morse.builder.components.matter import Matter, set_collision
from morse.builder.errors import checks
from morse.core.exceptions import MorseBuilderError

if TYPE_CHECKING:
    from collections.abc import Iterable

    from morse.builder.objects import LiveVector


class PassiveObject(Matter):
    """Objects from a model file.

    Args:
        filename: name of the model, e.g. ``props/objects`` (see `morse.assets.find`).
        prefix: only objects whose names begin with it, or the collection of that name; None for all.
        keep_pose: whether to keep the pose of the first object in the file; otherwise it is moved to the origin.
        object_name: only the object with this name, and those below it; instead of ``prefix``.
        collision: collision shapes of its meshes: ``hull`` (the convex hull of each), ``decompose`` (at most 32 convex
            parts, by `CoACD <https://github.com/SarahWeiii/CoACD>`_ if it is installed), ``mesh`` (exact), ``box``,
            ``sphere``, ``cylinder``, ``cone``, ``capsule``. By default, objects that move have exact shapes if 32 are
            enough, otherwise an approximation by so many, and static ones have exact shapes.

    Raises:
        FileNotFoundError: there is no such model.
        MorseBuilderNoComponentError: no object in the model has such a name.
    """

    def __init__(
        self,
        filename: str = "props/objects",
        prefix: str | None = None,
        keep_pose: bool = False,
        object_name: str | None = None,
        *,
        collision: str | None = None,
    ) -> None:
        super().__init__(filename=checks.text(filename, "PassiveObject(filename)"))
        if prefix is not None:
            checks.text(prefix, "PassiveObject(prefix)")
        names = None if object_name is None else [checks.text(object_name, "PassiveObject(object_name)")]
        self.set_blender_object(self.append_meshes(names, prefix=prefix)[0])
        if collision is not None:
            set_collision(self.own_nodes(), collision, "PassiveObject(collision)")
        if not checks.boolean(keep_pose, "PassiveObject(keep_pose)"):
            self.scene_node.parent_inverse = None
            self.location = (0.0, 0.0, 0.0)
            self.rotation_euler = (0.0, 0.0, 0.0)

    def setgraspable(self) -> None:
        """Allow robots to grasp it, and cameras to recognise it, under its present name."""
        self.properties(Object=True, Graspable=True, Label=self.name)


class Zone(AbstractComponent):
    """An invisible axis-aligned box with a type, e.g. for charging batteries.

    Args:
        type: type of the zone, e.g. ``Charging``.
    """

    def __init__(self, type: str) -> None:
        super().__init__()
        self.type = checks.text(type, "Zone(type)")
        self.set_blender_object(new_object("Zone"))
        self.scene_node.visible = False
        self.properties(Zone_Tag=True, Type=self.type)

    @property
    def size(self) -> LiveVector:
        """Half extent along each axis, m."""
        return self.scale

    @size.setter
    def size(self, value: Iterable[float]) -> None:
        extents = checks.triple(value, "Zone.size")
        if min(extents) <= 0.0:
            raise ValueError(f"Zone.size takes three half extents greater than 0, got {checks.shown(extents)}")
        self.scale = extents

    def rotate(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> NoReturn:
        """Raise an error, because zones are axis-aligned.

        Raises:
            MorseBuilderError: always.
        """
        raise MorseBuilderError(
            "a Zone cannot be rotated: its sides follow the axes of the world; set its size instead"
        )
