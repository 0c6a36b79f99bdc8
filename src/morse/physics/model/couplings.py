"""Adds constraints to the model of the engine: of armatures and of MJCF files, with their springs and dampers.

Constraints of MJCF files whose bodies are different objects of the scene are added here, such as a weld between a hand
and a body that shows where it is to go; those within a robot come with the robot.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.poses.rigid import relative_pose
from morse.scene import is_dynamic
from morse.scene.articulation import ConstraintKind

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.core.world import Body
    from morse.physics.model.files import Part
    from morse.physics.model.layout import Frame, Slot
    from morse.scene import Node
    from morse.scene.articulation import Constraint


_WELD, _TENDON = mujoco.mjtEq.mjEQ_WELD, mujoco.mjtEq.mjEQ_TENDON
_BODY, _SITE = mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_SITE
_OF_PAIRS = ("condim", "friction", "solref", "solimp", "solreffriction", "margin", "gap")


def add_links(spec: mujoco.MjSpec, parts: Sequence[Part]) -> None:
    """Add what joins the parts of each file.

    Args:
        spec: the model of the scene, to which the parts are attached.
    """
    for together in _of_one_file(parts):
        if len(together) > 1 and any(
            word in text for text in together[0].model.file.texts for word in ("<equality", "<pair", "<exclude")
        ):
            _Links(spec, together).add()


def _of_one_file(parts: Sequence[Part]) -> Iterator[list[Part]]:
    """Return the parts that come from one file; of several robots of a file, the first has the first object of each."""
    files: dict[int, dict[tuple[str, ...], list[Part]]] = {}
    for part in parts:
        files.setdefault(id(part.model.file), {}).setdefault(part.model.tops, []).append(part)
    for by_tops in files.values():
        for together in zip_longest(*by_tops.values()):
            yield [part for part in together if part is not None]


class _Links:
    def __init__(self, spec: mujoco.MjSpec, parts: list[Part]) -> None:
        self._spec = spec
        self._source = parts[0].model.file.spec()
        self._prefixes = {name: part.prefix for part in parts for name in part.model.links.values()}

    def add(self) -> None:
        data = None
        for number, equality in enumerate(self._source.equalities):
            places = [self._of_element(equality, name) for name in (equality.name1, equality.name2)]
            if equality.type == _TENDON or not self._is_between(places):
                continue
            data = self._source.compile().eq_data if data is None else data
            self._spec.add_equality(
                name=f"{places[0]}{equality.name or number}",
                type=equality.type,
                objtype=equality.objtype,
                name1=places[0] + equality.name1,
                name2=places[1] + equality.name2,
                # without a relative pose, that of the file
                data=data[number] if equality.type == _WELD else equality.data,
                active=equality.active,
                solref=equality.solref,
                solimp=equality.solimp,
            )
        for pair in self._source.pairs:
            geoms = [self._source.geom(name) for name in (pair.geomname1, pair.geomname2)]
            places = [None if geom is None else self._prefixes.get(geom.parent.name) for geom in geoms]
            if self._is_between(places):
                copy = self._spec.add_pair(geomname1=places[0] + geoms[0].name, geomname2=places[1] + geoms[1].name)
                for name in _OF_PAIRS:
                    setattr(copy, name, getattr(pair, name))
        for pair in self._source.excludes:
            places = [self._prefixes.get(name) for name in (pair.bodyname1, pair.bodyname2)]
            if self._is_between(places):
                self._spec.add_exclude(bodyname1=places[0] + pair.bodyname1, bodyname2=places[1] + pair.bodyname2)

    def _of_element(self, equality: mujoco.MjsEquality, name: str) -> str | None:
        """The prefix of the part to which one of the two elements of a constraint belongs."""
        if equality.objtype == _BODY and equality.type in (_WELD, mujoco.mjtEq.mjEQ_CONNECT):
            return self._prefixes.get(name)
        element = self._source.site(name) if equality.objtype == _SITE else self._source.joint(name)
        return None if element is None else self._prefixes.get(element.parent.name)

    @staticmethod
    def _is_between(places: Sequence[str | None]) -> bool:
        return None not in places and len(set(places)) == 2


#: share of the acceleration of a constraint that the engine achieves: with the rest, 0.01 %, it remains solvable where
#: several constraints hold the same
_ACHIEVED = 0.9999


def stiff(step: float) -> tuple[tuple[float, float], tuple[float, ...]]:
    """Return ``solref`` and ``solimp`` of a constraint that holds as a joint does.

    Args:
        step: of the engine, s.
    """
    return (2.0 * step, 1.0), (_ACHIEVED, _ACHIEVED, 0.001, 0.5, 2.0)


_EQUALITIES = {
    ConstraintKind.CONNECT: mujoco.mjtEq.mjEQ_CONNECT,
    ConstraintKind.WELD: mujoco.mjtEq.mjEQ_WELD,
    ConstraintKind.JOINT: mujoco.mjtEq.mjEQ_JOINT,
}
_OBJECTS = {
    ConstraintKind.CONNECT: mujoco.mjtObj.mjOBJ_BODY,
    ConstraintKind.WELD: mujoco.mjtObj.mjOBJ_BODY,
    ConstraintKind.JOINT: mujoco.mjtObj.mjOBJ_JOINT,
}


@dataclass(slots=True)
class _Place:
    """A link: its body in the engine, and its pose there."""

    slot: Slot
    body: Body
    position: NDArray[np.float64]
    rotation: NDArray[np.float64]

    def point(self, local: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
        """A point of the link in the frame of the body."""
        point: NDArray[np.float64] = self.position + matmul(self.rotation, np.array(local))
        return point


class CouplingBuilder:
    """The couplings of all armatures of a scene.

    Args:
        spec: receives them.
        slots: of all frames.
        bodies: of the engine, by frame.
    """

    def __init__(self, spec: mujoco.MjSpec, slots: Sequence[Slot], bodies: Mapping[Frame, mujoco.MjsBody]) -> None:
        self._spec, self._bodies = spec, bodies
        self._slot_of = {node: slot for slot in slots for node in slot.frame.members}
        for armature in self._slot_of:
            if armature.articulation is not None and armature.bones and is_dynamic(armature):
                self._add(armature)

    def _add(self, armature: Node) -> None:
        assert armature.articulation is not None
        couplings = armature.articulation.couplings
        links = {child.source_name or child.name: child for child in armature.children}
        for number, constraint in enumerate(couplings.constraints):
            self._add_constraint(armature, links, constraint, number)

    def _place(self, armature: Node, links: Mapping[str, Node], name: str) -> _Place:
        # a world without shapes is no link
        node = links.get(name, armature)
        slot = self._slot_of[node]
        return _Place(slot, self._bodies[slot.frame], *relative_pose(node, slot.pose))

    def _add_constraint(self, armature: Node, links: Mapping[str, Node], constraint: Constraint, number: int) -> None:
        kind = constraint.kind
        data = np.zeros(12)
        data[: len(constraint.data)] = constraint.data[:12]
        names = [constraint.one, constraint.other]
        if kind in (ConstraintKind.CONNECT, ConstraintKind.WELD):
            one, other = (self._place(armature, links, name) for name in names)
            if one.body is other.body:
                return
            names = [one.body.name, other.body.name]
            first, second = (one, other) if kind is ConstraintKind.CONNECT else (other, one)
            data[:3], data[3:6] = first.point(data[:3]), second.point(data[3:6])
            if kind is ConstraintKind.WELD:
                # of the second body in the first one
                data[6:10] = _quaternion(matmul(matmul(one.rotation, _matrix(data[6:10])), other.rotation.T))
        else:
            names = [f"{armature.name}/{name}" if name else "" for name in names]
        solref: Sequence[float]
        solref, solimp = stiff(float(self._spec.option.timestep))
        if constraint.solver is not None:
            solref, solimp = constraint.solver[:2], constraint.solver[2:]
        element = self._spec.add_equality(
            name=f"{armature.name}/constraint {number}",
            type=_EQUALITIES[kind],
            objtype=_OBJECTS[kind],
            name1=names[0],
            name2=names[1],
            active=constraint.is_active,
            solref=solref,
            solimp=solimp,
        )
        element.data = data


def _matrix(quaternion: Sequence[float] | NDArray[np.float64]) -> NDArray[np.float64]:
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, np.array(quaternion, dtype=np.float64))
    return rotation.reshape(3, 3)


def _quaternion(rotation: NDArray[np.float64]) -> NDArray[np.float64]:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(rotation).ravel())
    return quaternion
