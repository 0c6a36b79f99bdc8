"""A model as a scope: its links, joints, frames and nested models, and the poses of all of them, also in one frame.

Each pose is relative to a frame that is named. Without a name, it is relative to the frame of the model, that of a
joint to its child, and that of a frame to the frame to which it is attached. See
http://sdformat.org/tutorials?tut=pose_frame_semantics.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from morse.assets.gazebo.values import ValueMistakeError, boolean, pose_of, vector
from morse.mathutils import Matrix, Vector

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from pathlib import Path
    from xml.etree.ElementTree import Element


#: the frame of a model, and of the world
MODEL, WORLD = "__model__", "world"
#: names between the names of nested models
SEPARATOR = "::"


class FrameMistakeError(ValueError):
    """A frame does not exist, or depends on itself; the message contains its name."""


@dataclass(slots=True, eq=False)
class Part:
    """A link, joint or frame of a model.

    Attributes:
        path: the file that contains it.
        version: version of this file.
        home: the frame of the model in which the file declares it: `MODEL`, unless it was merged into another one.
        pose: 4x4, relative to the frame ``base``.
        base: name of a frame, or empty for the usual one.
        attached: of a frame: the name to which it is attached.
    """

    name: str
    element: Element
    path: Path
    version: tuple[int, ...]
    home: str = MODEL
    pose: Matrix = field(default_factory=lambda: Matrix.Identity(4))
    base: str = ""
    attached: str = ""


@dataclass(slots=True, eq=False)
class Scope:
    """A model or a world.

    Attributes:
        path: the file that declares it.
        pose: 4x4 of the model, or of its frame ``placement``, relative to the frame ``base`` of the scope above.
        static: whether it cannot move.
        canonical: name of the link whose motion the frame of the model follows; empty for the first one.
        placement: the frame whose pose is ``pose``; empty for that of the model.
        models: nested models.
        plugins: elements with the files that contain them.
        lights: elements, with frames at their poses.
        actors: elements with the files that contain them.
    """

    name: str
    path: Path
    pose: Matrix = field(default_factory=lambda: Matrix.Identity(4))
    base: str = ""
    static: bool = False
    self_collide: bool = False
    canonical: str = ""
    placement: str = ""
    links: dict[str, Part] = field(default_factory=dict)
    joints: dict[str, Part] = field(default_factory=dict)
    frames: dict[str, Part] = field(default_factory=dict)
    models: dict[str, Scope] = field(default_factory=dict)
    plugins: list[tuple[Element, Path]] = field(default_factory=list)
    lights: list[tuple[Element, Part]] = field(default_factory=list)
    actors: list[tuple[Element, Path]] = field(default_factory=list)
    _poses: dict[str, Matrix] = field(default_factory=dict)
    _asked: set[str] = field(default_factory=set)

    # -- poses -------------------------------------------------------------------------------

    def pose_of(self, name: str) -> Matrix:
        """The 4x4 pose of a link, joint, frame or nested model in the frame of this scope.

        Raises:
            FrameMistakeError: it does not exist, or depends on itself.
        """
        if name in (MODEL, WORLD, "__root__", ""):
            return Matrix.Identity(4)
        if name in self._poses:
            return self._poses[name]
        if name in self._asked:
            raise FrameMistakeError(f"the pose of '{name:.60}' depends on itself")
        self._asked.add(name)
        try:
            self._poses[name] = self._computed(name)
        finally:
            self._asked.discard(name)
        return self._poses[name]

    def replace_models(self, names: Iterable[str], model: Scope) -> None:
        """Put a model in the place of others, which it has."""
        for name in names:
            del self.models[name]
        self.models[model.name] = model
        self._poses.pop(model.name, None)

    def place_of(self, part: Part) -> Matrix:
        """The 4x4 pose of a part in the frame of this scope; see `pose_of`."""
        result: Matrix = self.pose_of(self._base_of(part)) @ part.pose
        return result

    def _computed(self, name: str) -> Matrix:
        part = self.links.get(name) or self.frames.get(name) or self.joints.get(name)
        if part is not None:
            return self.place_of(part)
        model = self.models.get(name)
        if model is not None:
            pose = self.pose_of(model.base) @ model.pose
            return pose @ model.pose_of(model.placement).inverted() if model.placement else pose
        head, separator, rest = name.partition(SEPARATOR)
        if separator and head in self.models:
            return self.pose_of(head) @ self.models[head].pose_of(rest)
        raise FrameMistakeError(f"'{self.name:.60}' has no link, joint, frame or model '{name:.60}'")

    def _base_of(self, part: Part) -> str:
        if part.base:
            return part.base
        if part.name in self.joints and self.joints[part.name] is part:
            return child_of(part)
        return part.attached or part.home

    # -- links -------------------------------------------------------------------------------

    def link_of(self, name: str, *, depth: int = 0) -> str:
        """The link to which a frame, a joint or a model is attached, as a name in this scope; or `WORLD`.

        Raises:
            FrameMistakeError: there is no such frame, or it is attached to itself.
        """
        if depth > len(self.frames) + len(self.joints) + 2:
            raise FrameMistakeError(f"the frame '{name:.60}' is attached to itself")
        if name in self.links or name == WORLD:
            return name
        if name in self.frames:
            frame = self.frames[name]
            return self.link_of(frame.attached or frame.home, depth=depth + 1)
        if name in self.joints:
            return self.link_of(child_of(self.joints[name]), depth=depth + 1)
        if name in (MODEL, ""):
            return self.first_link()
        head, separator, rest = name.partition(SEPARATOR)
        if head in self.models:
            inner = self.models[head].link_of(rest if separator else MODEL)
            return inner if inner == WORLD else f"{head}{SEPARATOR}{inner}"
        raise FrameMistakeError(f"'{self.name:.60}' has no link, joint, frame or model '{name:.60}'")

    def first_link(self) -> str:
        """The canonical link.

        Raises:
            FrameMistakeError: the model has no link.
        """
        if self.canonical and self.canonical != MODEL:
            return self.link_of(self.canonical)
        if self.links:
            return next(iter(self.links))
        for name, model in self.models.items():
            if model.has_links():
                return f"{name}{SEPARATOR}{model.first_link()}"
        raise FrameMistakeError(f"'{self.name:.60}' has no link")

    def has_links(self) -> bool:
        """Whether the model or a nested one has a link."""
        return bool(self.links) or any(model.has_links() for model in self.models.values())


def child_of(joint: Part) -> str:
    """The name of the child of a joint."""
    return end_of(joint, "child")


def end_of(joint: Part, tag: str) -> str:
    """The name in the element ``parent`` or ``child`` of a joint; the oldest files have it in an attribute."""
    element = joint.element.find(tag)
    return "" if element is None else (element.text or "").strip() or (element.get("link") or "").strip()


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
