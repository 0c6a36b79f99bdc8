"""Forces of contacts on objects, and forces in joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.contact_points import ContactPoints
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.gliding.gliding import Gliding
    from morse.physics.objects.gameobject import GameObject
    from morse.physics.objects.object_world import ObjectWorld
    from morse.physics.objects.posed import Posed
    from morse.scene import Node

_Vector = tuple[float, float, float]


_PYRAMID = int(mujoco.mjtCone.mjCONE_PYRAMIDAL)
_NONE = (0.0, 0.0, 0.0)


class _Solved:
    """The contacts of one moment and their forces: copies, which do not change with the engine."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData | None) -> None:
        self._count = 0 if data is None else data.ncon
        if data is None or not self._count:
            return
        contact = data.contact
        self._geoms, self._addresses = np.array(contact.geom), np.array(contact.efc_address)
        self._sizes, self._frames, self._forces = np.array(contact.dim), np.array(contact.frame), data.efc_force.copy()
        # of each tangential direction
        self._frictions = np.array(contact.friction) if model.opt.cone == _PYRAMID else None

    def on(self, own: NDArray[np.bool_], nodes: Sequence[Node]) -> list[tuple[Node, _Vector]]:
        """Return nodes and forces (N, world axes) of what touches some shapes, see `ContactMoment`."""
        pairs: list[tuple[Node, _Vector]] = []
        if not self._count:
            return pairs
        sides = own[self._geoms]
        for index in np.flatnonzero(sides[:, 0] != sides[:, 1]).tolist():
            if self._addresses[index] < 0:
                continue
            # on the second shape
            force = matmul(self._frames[index].reshape(3, 3).T, self._force(index))
            x, y, z = (force if sides[index, 1] else -force).tolist()
            pairs.append((nodes[int(self._geoms[index, 0 if sides[index, 1] else 1])], (x, y, z)))
        return pairs

    def _force(self, index: int) -> NDArray[np.float64]:
        """Return the force of a contact (3,) in the axes of the contact."""
        first, size, wrench = int(self._addresses[index]), int(self._sizes[index]), np.zeros(6)
        if size == 1 or self._frictions is None:
            wrench[:size] = self._forces[first : first + size]
        else:
            edges = self._forces[first : first + 2 * (size - 1)]
            mujoco.mju_decodePyramid(wrench[:size], edges, self._frictions[index, : size - 1])
        return wrench[:3]


class ContactMoment(NamedTuple):
    """The contacts of an object at one moment.

    Attributes:
        solved: all contacts.
        own: (G,) shapes of the object.
        nodes: [G] nodes of the shapes.
        world: finds the objects of nodes.
    """

    solved: _Solved
    own: NDArray[np.bool_]
    nodes: Sequence[Node]
    world: ObjectWorld

    def forces(self) -> list[tuple[GameObject, _Vector]]:
        """See `morse.core.world.Body.contact_forces`."""
        pairs = [(self.world.find_object(node), force) for node, force in self.solved.on(self.own, self.nodes)]
        return [(obj, force) for obj, force in pairs if obj is not None]


class JointMoment(NamedTuple):
    """What loads the joint that carries an object, at one moment.

    Attributes:
        wrench: (6,) torque and force of the object on what carries it, about ``centre``; None without a joint.
        centre: (3,) m.
    """

    wrench: NDArray[np.float64] | None
    centre: NDArray[np.float64]

    def load(self, origin: Sequence[float]) -> tuple[_Vector, _Vector]:
        """See `morse.core.world.body.JointMoment.load`: of a load that hangs, the force points down."""
        if self.wrench is None:
            return _NONE, _NONE
        tx, ty, tz, fx, fy, fz = (-self.wrench).tolist()
        cx, cy, cz = self.centre.tolist()
        x, y, z = origin
        x, y, z = cx - x, cy - y, cz - z
        return (fx, fy, fz), (tx + y * fz - z * fy, ty + z * fx - x * fz, tz + x * fy - y * fx)


_UNLOADED = JointMoment(None, np.zeros(3))


class Reactions:
    """Computes forces of the last step of the engine; those of sleeping bodies from a copy of the state.

    The forces of a moment are copied once for all who ask in a tick.
    """

    #: created from the scene, without a state
    is_apparatus = True

    def __init__(self, world: ObjectWorld) -> None:
        self._world = world
        self._model: mujoco.MjModel | None = None

    def take(self, gliding: Gliding) -> Reactions:
        """Look up the shapes again after objects were added or removed."""
        world = self._world
        if self._model is not world.model:
            self._model = world.model
            self._points = ContactPoints(world, gliding)
            self._geoms: dict[str, NDArray[np.bool_]] = {}
            self._stamp = -1
        if self._stamp != world.stamp:
            self._stamp = world.stamp
            self._some_sleep = bool((world.data.tree_asleep >= 0).any())
            #: of the awake bodies, once somebody asks
            self._solved: _Solved | None = None
            self._wrenches: tuple[NDArray[np.float64], NDArray[np.float64]] | None = None
        return self

    def _own(self, obj: Posed) -> NDArray[np.bool_]:
        """Which shapes belong to an object and the objects below it."""
        own = self._geoms.get(obj.node.name)
        if own is None:
            nodes = {id(node) for node in obj.node.walk()}
            own = np.array([id(node) in nodes for node in self._world.geom_node], dtype=bool)
            self._geoms[obj.node.name] = own
        return own

    def _sleeps(self, body: int) -> bool:
        if not self._some_sleep:
            return False
        tree = int(self._world.model.body_treeid[body])
        return tree >= 0 and self._world.data.tree_asleep[tree] >= 0

    def contact_moment(self, obj: Posed) -> ContactMoment:
        """Return the present contacts of an object; those between its parts are left out."""
        world = self._world
        if self._sleeps(world.slots[obj.slot].body):
            with self._points.everything() as copy:
                solved = _Solved(world.model, copy)
        else:
            if self._solved is None:
                self._solved = _Solved(world.model, world.data)
            solved = self._solved
        return ContactMoment(solved, self._own(obj), world.geom_node, world)

    def joint_moment(self, obj: Posed) -> JointMoment:
        """Return what loads the joint that carries an object."""
        world = self._world
        slot = world.slots[obj.slot]
        if slot.frame.motion is not Motion.JOINT:
            return _UNLOADED
        if self._sleeps(slot.body):
            with self._points.everything() as copy:
                if copy is None:
                    return _UNLOADED
                wrenches, centres = self._loads(copy)
        else:
            if self._wrenches is None:
                self._wrenches = self._loads(world.data)
            wrenches, centres = self._wrenches
        return JointMoment(wrenches[slot.body], centres[world.model.body_rootid[slot.body]])

    def _loads(self, data: mujoco.MjData) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        mujoco.mj_rnePostConstraint(self._world.model, data)
        return data.cfrc_int.copy(), data.subtree_com.copy()
