"""Forces of contacts on objects, and forces in joints."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.contact_points import ContactPoints
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from morse.physics.gliding.gliding import Gliding
    from morse.physics.objects.posed import Posed
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node

_Vector = tuple[float, float, float]


class Reactions:
    """Computes forces of the last step of the engine; those of sleeping bodies from a copy of the state."""

    #: created from the scene, without a state
    is_apparatus = True

    def __init__(self, state: EngineState) -> None:
        self._world = state
        self._model: mujoco.MjModel | None = None
        self._wrench = np.zeros(6)

    def take(self, gliding: Gliding) -> Reactions:
        """Look up the shapes again after objects were added or removed."""
        world = self._world
        if self._model is not world.model:
            self._model = world.model
            self._points = ContactPoints(world, gliding)
            self._geoms: dict[str, NDArray[np.bool_]] = {}
        return self

    def _own(self, obj: Posed) -> NDArray[np.bool_]:
        """Which shapes belong to an object and the objects below it."""
        own = self._geoms.get(obj.node.name)
        if own is None:
            nodes = {id(node) for node in obj.node.walk()}
            own = np.array([id(node) in nodes for node in self._world.geom_node], dtype=bool)
            self._geoms[obj.node.name] = own
        return own

    @contextmanager
    def _awake(self, body: int) -> Iterator[mujoco.MjData | None]:
        """The state, or a copy of it with the forces of sleeping bodies."""
        world = self._world
        tree = int(world.model.body_treeid[body])
        if tree >= 0 and world.data.tree_asleep[tree] >= 0:
            with self._points.everything() as copy:
                yield copy
        else:
            yield world.data

    def contacts(self, obj: Posed) -> list[tuple[Node, _Vector]]:
        """Return what presses on an object: nodes of other objects, and forces on this object, N, world axes.

        Contacts between parts of the object are left out.
        """
        world = self._world
        own = self._own(obj)
        pairs: list[tuple[Node, _Vector]] = []
        with self._awake(world.slots[obj.slot].body) as data:
            if data is None or not data.ncon:
                return pairs
            contact = data.contact
            geoms = contact.geom[: data.ncon]
            sides = own[geoms]
            chosen = np.flatnonzero(sides[:, 0] != sides[:, 1]).tolist()
            for index in chosen:
                if contact.efc_address[index] < 0:
                    continue
                mujoco.mj_contactForce(world.model, data, index, self._wrench)
                # on the second shape
                force = matmul(contact.frame[index].reshape(3, 3).T, self._wrench[:3])
                x, y, z = (force if sides[index, 1] else -force).tolist()
                other = int(geoms[index, 0 if sides[index, 1] else 1])
                pairs.append((world.geom_node[other], (x, y, z)))
        return pairs

    def joint(self, obj: Posed) -> tuple[_Vector, _Vector]:
        """Return force (N) and torque (N m, about the origin of the object) in the joint that carries an object.

        They are those that the body of the object exerts on the body that carries it, in world axes: of a load that
        hangs, the force points down. They are 0 if no joint carries the object.
        """
        world = self._world
        slot = world.slots[obj.slot]
        body = slot.body
        if slot.frame.motion is not Motion.JOINT:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        with self._awake(body) as data:
            if data is None:
                return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
            mujoco.mj_rnePostConstraint(world.model, data)
            tx, ty, tz, fx, fy, fz = (-data.cfrc_int[body]).tolist()
            cx, cy, cz = data.subtree_com[world.model.body_rootid[body]].tolist()
        x, y, z = obj.world_pose()[0]
        x, y, z = cx - x, cy - y, cz - z
        return (fx, fy, fz), (tx + y * fz - z * fy, ty + z * fx - x * fz, tz + x * fy - y * fx)
