"""Contact points of bodies, the forces of contacts on objects, and forces in joints."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeAlias, TypeVar

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from morse.physics.gliding.gliding import Gliding
    from morse.physics.model.layout import Slot
    from morse.physics.objects.object_world import Posed
    from morse.physics.state.engine_state import EngineState
    from morse.scene import Node


#: arrays that gliding changes so that the contacts of the feet need not be solved
_OF_GLIDING = ("geom_contype", "geom_conaffinity", "geom_gap", "body_margin", "body_gravcomp")


class ContactPoints:
    """Computes all contacts, including those that the engine skips for speed: of sleeping bodies and of driven feet.

    The class works on a copy of the state, so that observers do not affect the simulation.
    """

    def __init__(self, state: EngineState, gliding: Gliding) -> None:
        self._state = state
        self._gliding = gliding
        self._copy: mujoco.MjData | None = None

    def look(self) -> NDArray[np.float32]:
        """Return (N, 6) points (m) and forces (N) on the movable body, or on the second one; world axes."""
        with self.everything() as data:
            return np.empty((0, 6), dtype=np.float32) if data is None else self._rows(data)

    @contextmanager
    def everything(self) -> Iterator[mujoco.MjData | None]:
        """A copy of the state with all contacts and their forces; None if there are too many contacts."""
        model = self._state.model
        if self._copy is None:
            self._copy = mujoco.MjData(model)
        mujoco.mj_copyData(self._copy, model, self._state.data)
        with self._everything_awake():
            try:
                mujoco.mj_forward(model, self._copy)
            except mujoco.FatalError:  # the next tick excludes bodies
                self._copy = None
        yield self._copy

    def _rows(self, data: mujoco.MjData) -> NDArray[np.float32]:
        model = self._state.model
        rows = np.empty((data.ncon, 6), dtype=np.float32)
        wrench = np.zeros(6)
        for index, fixed in enumerate(self._second_is_fixed(data)):
            contact = data.contact[index]
            mujoco.mj_contactForce(model, data, index, wrench)
            force = matmul(contact.frame.reshape(3, 3).T, wrench[:3])
            rows[index, :3], rows[index, 3:] = contact.pos, -force if fixed else force
        return rows

    def _second_is_fixed(self, data: mujoco.MjData) -> NDArray[np.bool_]:
        model = self._state.model
        return np.asarray(model.body_weldid[model.geom_bodyid[data.contact.geom[: data.ncon, 1]]] == 0)

    @contextmanager
    def _everything_awake(self) -> Iterator[None]:
        model = self._state.model
        flags = model.opt.enableflags
        kept = {name: getattr(model, name).copy() for name in _OF_GLIDING}
        try:
            model.opt.enableflags = flags & ~int(mujoco.mjtEnableBit.mjENBL_SLEEP)
            self._gliding.all_stand()
            yield
        finally:
            model.opt.enableflags = flags
            for name, values in kept.items():
                getattr(model, name)[:] = values


_Vector = tuple[float, float, float]
_Loads: TypeAlias = "tuple[NDArray[np.float64], NDArray[np.float64]]"

#: objects of the world
_B = TypeVar("_B")

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
            # two edges for each tangential direction; `mju_decodePyramid` of Python leaves out the last two
            edges = self._forces[first : first + 2 * (size - 1)].reshape(-1, 2)
            wrench[0] = edges.sum()
            wrench[1:size] = (edges[:, 0] - edges[:, 1]) * self._frictions[index, : size - 1]
        return wrench[:3]


class ContactMoment(NamedTuple, Generic[_B]):
    """The contacts of objects at one moment.

    Attributes:
        solved, resting: all contacts; and those of sleeping objects, None if none of them slept.
        asleep: slots of the objects that slept.
        shapes: (G,) masks of the shapes of objects by name, which are filled on demand.
        nodes: [G] nodes of the shapes.
        find: the object of a node, or None if it is gone.
    """

    solved: _Solved
    resting: _Solved | None
    asleep: Collection[int]
    shapes: dict[str, NDArray[np.bool_]]
    nodes: Sequence[Node]
    find: Callable[[Node], _B | None]

    def forces(self, obj: Posed) -> list[tuple[_B, _Vector]]:
        """See `morse.core.world.Body.contact_forces`."""
        solved = self.resting if self.resting is not None and obj.slot in self.asleep else self.solved
        pairs = [(self.find(node), force) for node, force in solved.on(self._own(obj), self.nodes)]
        return [(other, force) for other, force in pairs if other is not None]

    def _own(self, obj: Posed) -> NDArray[np.bool_]:
        """Which shapes belong to an object and the objects below it."""
        own = self.shapes.get(obj.node.name)
        if own is None:
            nodes = {id(node) for node in obj.node.walk()}
            own = self.shapes[obj.node.name] = np.array([id(node) in nodes for node in self.nodes], dtype=bool)
        return own


class JointMoment(NamedTuple):
    """What loads the joints that carry objects, at one moment.

    Attributes:
        loads, resting: (B, 6) torque and force of each body on what carries it, about the centre of its tree, and
            these centres (B, 3), m; and those of sleeping objects, None if none of them slept.
        asleep: slots of the objects that slept.
        slots: the slots of the world.
        roots: (B,) the body at the top of the tree of each body.
        links: the body of each link of MJCF files.
    """

    loads: _Loads
    resting: _Loads | None
    asleep: Collection[int]
    slots: Sequence[Slot]
    roots: NDArray[np.int32]
    links: Mapping[Node, int]

    def is_carried(self, obj: Posed) -> bool:
        """Whether a joint carries an object."""
        return _carried_body(self.slots[obj.slot], obj.node, self.links) is not None

    def load(self, obj: Posed, origin: Sequence[float]) -> tuple[_Vector, _Vector]:
        """See `morse.core.world.body.JointMoment.load`: of a load that hangs, the force points down."""
        body = _carried_body(self.slots[obj.slot], obj.node, self.links)
        if body is None:
            return _NONE, _NONE
        wrenches, centres = self.resting if self.resting is not None and obj.slot in self.asleep else self.loads
        tx, ty, tz, fx, fy, fz = (-wrenches[body]).tolist()
        cx, cy, cz = centres[self.roots[body]].tolist()
        x, y, z = origin
        x, y, z = cx - x, cy - y, cz - z
        return (fx, fy, fz), (tx + y * fz - z * fy, ty + z * fx - x * fz, tz + x * fy - y * fx)


def _carried_body(slot: Slot, node: Node, links: Mapping[Node, int]) -> int | None:
    """Return the body, in the engine, whose joint carries a node; None if there is none."""
    link = next((body for one in (node, *node.ancestors()) if (body := links.get(one)) is not None), None)
    if link is not None:
        return link
    return slot.body if slot.frame.motion is Motion.JOINT else None


class Reactions(Generic[_B]):
    """Computes forces of the last step of the engine; those of sleeping bodies from a copy of the state.

    The forces of a moment are copied once for all who ask in a tick.

    Args:
        find: returns the object of a node, or None if it is gone.
    """

    #: created from the scene, without a state
    is_apparatus = True

    def __init__(self, world: EngineState, find: Callable[[Node], _B | None]) -> None:
        self._world, self._find = world, find
        self._model: mujoco.MjModel | None = None

    def take(self, gliding: Gliding) -> Reactions[_B]:
        """Look up the shapes again after objects were added or removed."""
        world = self._world
        if self._model is not world.model:
            self._model = world.model
            self._points = ContactPoints(world, gliding)
            #: masks of the shapes of objects, by name
            self._shapes: dict[str, NDArray[np.bool_]] = {}
            self._stamp = -1
        if self._stamp != world.stamp:
            self._stamp = world.stamp
            self._some_sleep = bool((world.data.tree_asleep >= 0).any())
            #: of the awake bodies, once somebody asks
            self._solved: _Solved | None = None
            self._wrenches: _Loads | None = None
        return self

    def _sleeping(self, objects: Iterable[Posed]) -> Collection[int]:
        """The slots of those that sleep."""
        if not self._some_sleep:
            return ()
        world = self._world
        slots = {obj.slot: int(world.model.body_treeid[world.slots[obj.slot].body]) for obj in objects}
        return {slot for slot, tree in slots.items() if tree >= 0 and world.data.tree_asleep[tree] >= 0}

    def contact_moment(self, objects: Iterable[Posed]) -> ContactMoment[_B]:
        """Return the present contacts of objects; those between the parts of an object are left out."""
        world, asleep, resting = self._world, self._sleeping(objects), None
        if asleep:
            with self._points.everything() as copy:
                resting = _Solved(world.model, copy)
        if self._solved is None:
            self._solved = _Solved(world.model, world.data)
        return ContactMoment(self._solved, resting, asleep, self._shapes, world.geom_node, self._find)

    def joint_moment(self, objects: Iterable[Posed]) -> JointMoment:
        """Return what loads the joints that carry objects."""
        world, asleep, resting = self._world, self._sleeping(objects), None
        if asleep:
            with self._points.everything() as copy:
                zeros = np.zeros((world.model.nbody, 6))
                resting = (zeros, zeros[:, :3]) if copy is None else self._loads(copy)
        if self._wrenches is None:
            self._wrenches = self._loads(world.data)
        return JointMoment(self._wrenches, resting, asleep, world.slots, world.model.body_rootid, world.link_bodies)

    def _loads(self, data: mujoco.MjData) -> _Loads:
        mujoco.mj_rnePostConstraint(self._world.model, data)
        return data.cfrc_int.copy(), data.subtree_com.copy()
