"""The largest loads of the motors of robots."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.mathutils.portable import norm
from morse.physics.model.inertia import bounding_box
from morse.physics.model.layout import Motion
from morse.physics.model.motors import Load, weight
from morse.physics.poses.poses import as_array
from morse.scene.frames import rigid_frame

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from morse.physics.model.articulated import AddedJoint, Group
    from morse.physics.model.layout import Frame


class _Stretched(NamedTuple):
    """A part of a robot whose joints are all stretched, seen from a point.

    Attributes:
        mass: kg.
        first: sum of mass times distance, kg m.
        second: sum of mass times squared distance, kg m^2.
        inertia: sum of the largest moments of inertia of the links about their centres, kg m^2.
    """

    mass: float
    first: float
    second: float
    inertia: float

    def moved(self, length: float) -> _Stretched:
        """Return the part as seen from a point that is farther away by a length, m."""
        first = self.first + self.mass * length
        return _Stretched(self.mass, first, self.second + length * (self.first + first), self.inertia)


class _Tree:
    """The links of a robot whose base is free: those below a link follow it in one piece."""

    def __init__(self, frames: Sequence[Frame], groups: Mapping[Frame, Group]) -> None:
        self._masses = np.array([groups[frame].mass for frame in frames])
        self._centres = np.array([groups[frame].centre for frame in frames])
        self._first = {frame: number for number, frame in enumerate(frames)}

    def without(self, frame: Frame, count: int, anchor: NDArray[np.float64]) -> tuple[float, float, float]:
        """Return mass, moment of inertia and moment of weight about a point, without a frame and what is below it.

        Args:
            count: number of these frames.
        """
        first = self._first[frame]
        mass = np.delete(self._masses, slice(first, first + count))
        x, y, z = (np.delete(self._centres, slice(first, first + count), axis=0) - anchor).T
        reach = np.sqrt(x * x + y * y + z * z)
        return _sum(mass), _sum(mass * reach * reach), weight(_sum(mass * reach), 1.0)


class Loads:
    """The loads of the motors of all robots of a scene.

    Args:
        groups: the moving frames, parents before their children.
    """

    def __init__(self, groups: Mapping[Frame, Group]) -> None:
        self._groups = groups
        self._below: dict[Frame, list[Frame]] = {}
        for frame in groups:
            if frame.motion is Motion.JOINT and frame.parent is not None:
                self._below.setdefault(frame.parent, []).append(frame)
        self._stretched: dict[Frame, _Stretched] = {}
        self._counts: dict[Frame, int] = {}
        for frame in reversed(list(groups)):
            self._counts[frame] = 1 + sum(self._counts[child] for child in self._below.get(frame, ()))
            if groups[frame].joints:
                self._stretched[frame] = self._reached(frame, groups[frame].joints[0].anchor)
        self._trees: dict[Frame, _Tree] = {}

    def of(self, entry: AddedJoint, *, slides: bool) -> Load:
        """Return the largest load of the motor of a joint, whatever the other joints do.

        Args:
            slides: whether the joint is prismatic.
        """
        load = self._reached(entry.frame, entry.anchor)
        root = root_of(entry.frame)
        mass, inertia, moment, down = 0.0, 0.0, 0.0, 0.0
        if root.motion is Motion.FREE:
            if root not in self._trees:
                self._trees[root] = _Tree(self._below_first(root), self._groups)
            mass, inertia, moment = self._trees[root].without(entry.frame, self._counts[entry.frame], entry.anchor)
        down = _reach_down(entry) if mass and not entry.limit.limited else 0.0
        if slides:
            return Load(load.mass, weight(load.mass, 1.0), mass, weight(mass, 1.0), slides)
        return Load(load.second + load.inertia, weight(load.first, 1.0), inertia, moment, slides, down)

    def _reached(self, frame: Frame, anchor: NDArray[np.float64]) -> _Stretched:
        """Return a frame and what is below it, as seen from a joint of the frame."""
        group = self._groups[frame]
        own = _Stretched(group.mass, 0.0, 0.0, group.moment)
        parts = [own.moved(norm(group.centre - anchor))]
        parts += [
            self._stretched[child].moved(norm(self._groups[child].joints[0].anchor - anchor))
            if child in self._stretched
            else self._reached(child, anchor)  # fixed to the frame
            for child in self._below.get(frame, ())
        ]
        return _Stretched(*map(sum, zip(*parts, strict=True)))

    def _below_first(self, root: Frame) -> list[Frame]:
        """Return a frame and those below it; each is followed by those below it."""
        order, queue = [], [root]
        while queue:
            order.append(queue.pop())
            queue += self._below.get(order[-1], ())
        return order


def _reach_down(entry: AddedJoint) -> float:
    """Return how far the shapes that a joint moves reach below it, m: the radius of a wheel."""
    frame = entry.frame
    lows = [
        float(bounding_box(shape, np.array(place.position), as_array(place.rotation))[0][2])
        for node in frame.solid
        for place in (rigid_frame(node),)
        for shape in node.shapes or ()
    ]
    return max(0.0, float(entry.anchor[2]) - min(lows)) if lows else 0.0


def root_of(frame: Frame) -> Frame:
    """Return the frame that carries the joints of a frame."""
    while frame.motion is Motion.JOINT:
        assert frame.parent is not None
        frame = frame.parent
    return frame


def _sum(values: NDArray[np.float64]) -> float:
    """Return the sum in the order of the values: other sums of numpy depend on the processor."""
    return float(np.cumsum(values)[-1]) if len(values) else 0.0
