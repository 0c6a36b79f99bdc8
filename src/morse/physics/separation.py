"""Bodies that overlap at the start part slowly.

A stiff contact pushes a body that lies 0.5 m deep in a hill out of it within a few steps, which throws the body many
metres high. Until they have parted, the contacts of bodies that overlap at the start are therefore soft, with a damping
so large that the bodies separate at a speed in proportion to the depth: the depth decays like exp(-t `_RATE`).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from morse.physics.model.files import model_of
from morse.physics.model.layout import Motion

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from numpy.typing import NDArray

    from morse.physics.state.engine_state import EngineState
    from morse.physics.tick import Tick

#: depth from which contacts would throw bodies by more than a centimetre, m
_DEEP = 0.01
#: depth at which bodies have parted, m; a body at rest lies 2 mm deep in its soft contacts
_PARTED = 0.005
#: speed of separation for each metre of depth, 1/s
_RATE = 1.5
#: damping of a soft contact, in units of its limit, one over the time step
_DAMPING = 0.8
#: above the priorities of friction and of driven robots, so that no other body makes the contact stiff
_PRIORITY = 4
#: vertical part of the contact normals of bodies that lie below the ground
_DOWN = -0.5
_MOVING = (Motion.FREE, Motion.JOINT, Motion.HINGE)


class Separation:
    """Makes the contacts of overlapping bodies soft, and stiff again when the bodies have parted.

    The contact parameters in the model are the only state, so that they are saved with it.

    Args:
        solver, priority: ``geom_solref`` and ``geom_priority`` of the model as compiled.
    """

    def __init__(
        self, state: EngineState, tick: Tick, solver: NDArray[np.float64], priority: NDArray[np.int32]
    ) -> None:
        self._state, self._tick = state, tick
        self._solver, self._priority = solver, priority
        rate = _DAMPING / float(state.model.opt.timestep)
        self._soft = -rate * _RATE, -rate
        self._bodies: list[tuple[int, NDArray[np.intp]]] = []

    @property
    def has_work(self) -> bool:
        """Whether the contacts of a body are soft."""
        return bool(self._bodies)

    def names(self) -> list[str]:
        """The bodies with soft contacts."""
        return [self._state.names[index] for index, _ in self._bodies]

    def begin(self, moved: Collection[int] | None = None, again: Iterable[str] = ()) -> None:
        """Find the bodies that overlap now; the contacts of the engine must be those of the present poses.

        Args:
            moved: only overlaps of these slots count; None for all.
            again: names of bodies whose contacts stay soft, however little they overlap.
        """
        state = self._state
        slots = {state.named[name] for name in again if name in state.named}
        lift: dict[int, float] = {}
        for pair, normal in _deep_contacts(state):
            both = [state.slot_of[state.geom_node[geom]] for geom in pair]
            roots = [self._root(index) for index in both]
            if roots[0] != roots[1] and (moved is None or not set(both).isdisjoint(moved)):
                slots.update(index for one in both for index in self._parts(one))
                for index, push in zip(roots, (-normal, normal), strict=True):
                    lift[index] = max(push, lift.get(index, push))
        soft = [index for index in sorted(slots) if state.slots[index].frame.motion in _MOVING]
        for index in soft:
            geoms = self._geoms(index)
            state.model.geom_solref[geoms] = self._soft
            state.model.geom_priority[geoms] = _PRIORITY
        self._lay_to_rest([index for index, push in lift.items() if push < _DOWN])
        self.resume()

    def resume(self) -> None:
        """Find the bodies with soft contacts, after the model was restored."""
        state = self._state
        self._bodies = []
        for geom in np.flatnonzero((state.model.geom_solref != self._solver).any(axis=1)).tolist():
            index = state.slot_of[state.geom_node[geom]]
            if not self._bodies or self._bodies[-1][0] != index:
                self._bodies.append((index, self._geoms(index)))
        self._tick.rearrange()

    def before_step(self) -> None:
        """Do nothing at the beginning of a tick."""

    def after_step(self) -> None:
        """Make the contacts of bodies that have parted stiff again; sleeping bodies have no contacts."""
        state = self._state
        if not state.data.nv_awake:
            return
        contact = state.data.contact
        deep = np.zeros(state.model.ngeom, dtype=bool)
        deep[np.asarray(contact.geom)[np.asarray(contact.dist) < -_PARTED].ravel()] = True
        awake, model, staying = state.data.body_awake, state.model, []
        for index, geoms in self._bodies:
            if deep[geoms].any() or not awake[state.slots[index].body]:
                staying.append((index, geoms))
                continue
            model.geom_solref[geoms] = self._solver[geoms]
            # a driven robot has set others since
            raised = geoms[model.geom_priority[geoms] == _PRIORITY]
            model.geom_priority[raised] = self._priority[raised]
        if len(staying) < len(self._bodies):
            self._bodies = staying
            self._tick.rearrange()

    def _lay_to_rest(self, buried: Iterable[int]) -> None:
        """Let objects sleep that are pushed down alone: they lie below the surface of a thin ground, and would fall."""
        state = self._state
        asleep = state.data.tree_asleep.copy()
        for index in buried:
            frame = state.slots[index].frame
            if model_of(frame) is not None:
                # it does what the file says; the engine ends with an error if something touches it that moves by itself
                continue
            if frame.motion is Motion.FREE and frame.robot is None and index not in state.attached:
                tree = int(state.model.body_treeid[state.slots[index].body])
                asleep[tree] = tree
        if not np.array_equal(asleep, state.data.tree_asleep):
            state.sleep.set(asleep)

    # -- the bodies of a robot ---------------------------------------------------------------

    def _root(self, index: int) -> int:
        return self._state.slot_of[self._state.slots[index].frame.root.node]

    def _parts(self, index: int) -> tuple[int, ...]:
        """Return a free robot with its wheels and links, or one body.

        The contacts of MJCF files stay as the files have them: feet may be soft on purpose.
        """
        root = self._root(index)
        frame = self._state.slots[root].frame
        if model_of(frame) is not None:
            return ()
        return (root, *self._state.attached.get(root, ())) if frame.motion is Motion.FREE else (index,)

    def _geoms(self, index: int) -> NDArray[np.intp]:
        slot = self._state.slots[index]
        geoms = [*(geom for geoms in slot.geoms.values() for geom in geoms), *slot.feet]
        return np.array(geoms, dtype=np.intp)


def _deep_contacts(state: EngineState) -> list[tuple[tuple[int, int], float]]:
    """Return the geoms of deep contacts, and the vertical part of the normal from the first to the second."""
    contact = state.data.contact
    deep = np.asarray(contact.dist) < -_DEEP
    pairs, normals = np.asarray(contact.geom)[deep].tolist(), np.asarray(contact.frame)[deep, 2].tolist()
    return [((a, b), up) for (a, b), up in zip(pairs, normals, strict=True)]
