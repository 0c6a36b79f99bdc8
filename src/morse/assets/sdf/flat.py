"""The links and joints of a model and its nested models, in the frame of the outermost one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, boolean, pose_of, vector
from morse.assets.sdf.scope import SEPARATOR, WORLD, FrameMistakeError, Part, child_of, end_of
from morse.mathutils import Matrix, Vector

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from xml.etree.ElementTree import Element

    from morse.assets.sdf.scope import Scope

#: versions in which axes are in the frame of the model
_OLD_AXES = (1, 4)


@dataclass(slots=True, eq=False)
class FlatLink:
    """A link.

    Attributes:
        name: with the names of nested models before it.
        pose: 4x4, in the frame of the outermost model.
        scope: the model that declares it.
        is_static: whether it, or a model around it, is static.
    """

    name: str
    part: Part
    pose: Matrix
    scope: Scope
    is_static: bool

    def place(self, element: Element, name: str = "") -> Matrix:
        """The 4x4 pose of something on the link, in its frame.

        Args:
            element: with an element ``pose``.
            name: its name, for messages.

        Raises:
            ValueMistakeError: the pose is wrong, or relative to a frame that does not exist.
        """
        pose = element.find("pose")
        base = "" if pose is None else pose.get("relative_to") or ""
        if not base or base == self.part.name:
            return pose_of(pose)
        try:
            inverse = self.scope.pose_of(self.part.name).inverted()
            result: Matrix = inverse @ self.scope.pose_of(base) @ pose_of(pose)
        except FrameMistakeError as error:
            raise ValueMistakeError(f"<{element.tag} name='{name:.60}'>: {error}") from None
        return result


@dataclass(slots=True, eq=False)
class FlatJoint:
    """A joint.

    Attributes:
        parent, child: names of links, or ``world``.
        pose: 4x4, in the frame of the outermost model.
        axes: unit vectors in the frame of the joint.
    """

    name: str
    element: Element
    parent: str
    child: str
    pose: Matrix
    axes: tuple[Vector, Vector]

    @property
    def kind(self) -> str:
        """The type in the file."""
        return (self.element.get("type") or "").strip()


def links_of(model: Scope, prefix: str = "", pose: Matrix | None = None, static: bool = False) -> Iterator[FlatLink]:
    """The links of a model, and of its nested models."""
    outer = pose or Matrix.Identity(4)
    is_static = static or model.static
    for name, part in model.links.items():
        yield FlatLink(f"{prefix}{name}", part, outer @ model.pose_of(name), model, is_static)
    for name, child in model.models.items():
        yield from links_of(child, f"{prefix}{name}{SEPARATOR}", outer @ model.pose_of(name), is_static)


def joints_of(
    model: Scope, warn: Callable[[str], None], prefix: str = "", pose: Matrix | None = None
) -> Iterator[FlatJoint]:
    """The joints of a model, and of its nested models; those that refer to nothing are left out, with a warning."""
    outer = pose or Matrix.Identity(4)
    for name, part in model.joints.items():
        try:
            yield _joint(model, part, prefix, outer)
        except (FrameMistakeError, ValueMistakeError) as error:
            warn(f"the joint '{prefix}{name:.80}' is left out: {error}")
    for name, child in model.models.items():
        yield from joints_of(child, warn, f"{prefix}{name}{SEPARATOR}", outer @ model.pose_of(name))


def _joint(model: Scope, part: Part, prefix: str, outer: Matrix) -> FlatJoint:
    parent, child = (model.link_of(name) for name in (end_of(part, "parent"), child_of(part)))
    axes = tuple(_axis(model, part, tag) for tag in ("axis", "axis2"))
    parent, child = (name if name == WORLD else f"{prefix}{name}" for name in (parent, child))
    pose = outer @ model.pose_of(part.name)
    return FlatJoint(f"{prefix}{part.name}", part.element, parent, child, pose, (axes[0], axes[1]))


def _axis(model: Scope, part: Part, tag: str) -> Vector:
    """An axis in the frame of the joint."""
    axis = part.element.find(tag)
    xyz = Vector(vector(axis, "xyz", (0.0, 0.0, 1.0)))
    if xyz.length < 1e-9:
        raise ValueMistakeError(f"its <{tag}> has length 0")
    xyz = xyz.normalized()
    if axis is None:
        return xyz
    element = axis.find("xyz")
    frame = "" if element is None else element.get("expressed_in") or ""
    if not frame and (part.version <= _OLD_AXES or boolean(axis, "use_parent_model_frame")):
        frame = part.home
    if not frame or frame == part.name:
        return xyz
    rotation = (model.pose_of(part.name).inverted() @ model.pose_of(frame)).to_3x3()
    axis_in_model: Vector = rotation @ xyz
    return axis_in_model
