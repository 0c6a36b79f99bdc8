"""Keeps the engine stable: bodies whose state diverges, and many bodies at one place.

A body whose state diverges is reset; the others are not affected. Bodies that are put inside each other, for example
robots that are all spawned at one point, have a number of contacts that grows with the square of their number. A few
thousand contacts take longer than a tick, and some ten thousand exhaust the memory of the engine, which would end the
run. Bodies with the most contacts are therefore excluded: they stop, float, and collide with nothing until the
simulation is reset or they are deleted.
"""

from __future__ import annotations

import logging
import math
from collections import deque
from contextlib import suppress
from dataclasses import dataclass
from time import monotonic
from typing import TYPE_CHECKING

import mujoco
import numpy as np

from morse.mathutils.portable import matmul
from morse.physics.engine_functions import count_weightless
from morse.physics.model.layout import Motion
from morse.physics.poses.convert import RUNAWAY_DISTANCE, RUNAWAY_SPEED
from morse.physics.poses.kinematics import IN_GAP
from morse.physics.state import engine_values

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from morse.physics.gliding.gliding import Gliding
    from morse.physics.model.layout import Slot
    from morse.physics.state.engine_state import EngineState

logger = logging.getLogger(__name__)


#: warnings that were logged already, because the engine repeats them in every step
_said: set[str] = set()


def _warn(text: str) -> None:
    kind = text.partition(" at ")[0].partition(". Time")[0]
    if kind not in _said:
        _said.add(kind)
        logger.warning("%s", text)


# without this handler, the engine would write its warnings to a file in the working directory
mujoco.set_mju_user_warning(_warn)


class UnstableError(Exception):
    """The physics diverges even after a reset of the affected bodies; see `morse.physics.stability`.

    Attributes:
        body: name of the body that diverged first.
    """

    def __init__(self, body: str, what: str) -> None:
        super().__init__(
            f"the physics of '{body}' diverged ({what}), and diverged again after a reset. Look for bodies that "
            "start inside each other, for masses that differ by more than 1:1000, and for forces or speeds that are "
            "far too large"
        )
        self.body = body


#: largest number of contacts between moving bodies: a constant, and in addition a number for each moving body; heaps of
#: boxes have a fraction of them
_MOST, _MOST_EACH = 2000, 16


class Crowding:
    """Finds and excludes bodies that overlap too many other bodies.

    Args:
        free: the bodies of the engine that move freely, with their names.
        rescue: logs errors.
    """

    def __init__(self, state: EngineState, free: dict[int, str], rescue: Rescue) -> None:
        self._state = state
        self._rescue = rescue
        model = state.model
        self._names = free
        self._is_free = np.zeros(model.nbody, dtype=bool)
        self._is_free[list(free)] = True
        #: the body at the top of the tree to which a geom belongs
        self._root = model.body_rootid[model.geom_bodyid]
        self.most = _MOST + _MOST_EACH * len(free)

    def relieve(self) -> bool:
        """Exclude bodies if the last step found too many contacts; return whether any body was excluded."""
        return self._state.data.ncon > self.most and self._exclude(self._pairs(self._state.data))

    def relieve_at_once(self) -> bool:
        """Exclude bodies after the engine has run out of memory; return whether any body was excluded.

        The state of the engine is valid, but its contacts are unknown.
        """
        data = mujoco.MjData(self._state.model)
        data.qpos[:] = self._state.data.qpos
        data.mocap_pos[:], data.mocap_quat[:] = self._state.data.mocap_pos, self._state.data.mocap_quat
        mujoco.mj_kinematics(self._state.model, data)
        mujoco.mj_comPos(self._state.model, data)
        with suppress(mujoco.FatalError):  # the contacts that fit into the memory suffice
            mujoco.mj_collision(self._state.model, data)
        return self._exclude(self._pairs(data))

    def _pairs(self, data: mujoco.MjData) -> NDArray[np.int32]:
        """Return (N, 2) bodies for the contacts between two bodies that move freely."""
        # contacts within the gaps around gliding robots do not count
        geoms = data.contact.geom[data.contact.exclude != IN_GAP]
        pairs: NDArray[np.int32] = self._root[geoms]
        free = self._is_free[pairs].all(axis=1) & (pairs[:, 0] != pairs[:, 1])
        return np.asarray(pairs[free])

    def _exclude(self, pairs: NDArray[np.int32]) -> bool:
        excluded = 0
        while len(pairs) > self.most // 2:
            counts = np.bincount(pairs.ravel(), minlength=self._state.model.nbody)
            # of bodies with equal numbers of contacts the last one, which has probably come last
            body = len(counts) - 1 - int(np.argmax(counts[::-1]))
            self._set_aside(body)
            excluded += 1
            if excluded == 1:
                first = body
            pairs = pairs[(pairs != body).all(axis=1)]
        if excluded:
            count_weightless(self._state)
            others = f" and {excluded - 1} other bodies overlap" if excluded > 1 else " overlaps"
            self._rescue.report(
                f"'{self._names[first]}'{others} so many bodies that the contacts take longer than a tick: until the "
                "next reset, what overlaps floats at its place and collides with nothing. Put objects beside each "
                "other"
            )
        return excluded > 0

    def _set_aside(self, body: int) -> None:
        model, data = self._state.model, self._state.data
        geoms = self._root == body
        model.geom_contype[geoms] = model.geom_conaffinity[geoms] = 0
        model.body_gravcomp[model.body_rootid == body] = 1.0
        dofs = model.body_rootid[model.dof_bodyid] == body
        for values in (data.qvel, data.qacc_warmstart, data.qfrc_applied):
            values[dofs] = 0.0


_norm = mujoco.mju_norm
#: resets of one body within this time, s, count as one event
_EVENT = 1.0
#: s between two reports
_QUIET = 10.0
#: maximum number of resets that are kept
_REMEMBERED = 100
#: maximum number of bodies that are reset one by one in a tick; further diverged bodies are reset together
_ONE_BY_ONE = 8


@dataclass(frozen=True, slots=True)
class Recovery:
    """A body that diverged and was reset.

    Attributes:
        time: simulated seconds.
        body: name of the body.
        what: description of the value that diverged.
    """

    time: float
    body: str
    what: str


class Rescue:
    """Finds bodies whose state has diverged, and resets them to their last valid pose, at rest.

    Attributes:
        recoveries: the last events.
        count: the number of resets of all bodies.
    """

    def __init__(self) -> None:
        self.recoveries: deque[Recovery] = deque(maxlen=_REMEMBERED)
        self.count = 0
        self._last: dict[str, float] = {}
        self._reported = -math.inf

    def attach(self, state: EngineState, gliding: Gliding) -> None:
        """Use a model that was compiled again."""
        self._state = state
        self._gliding = gliding
        self._qvel, self._qpos = state.data.qvel, state.data.qpos

    def reset(self) -> None:
        """Forget the kept states, because the simulation restarts."""
        self._last.clear()

    def all_is_well(self) -> bool:
        """Whether the state has not diverged. NaN and infinity fail the comparison with the limits."""
        # unlike dot of numpy, the norm of the engine does not emit warnings, and it takes a third of the time
        return bool(_norm(self._qvel) < RUNAWAY_SPEED and _norm(self._qpos) < RUNAWAY_DISTANCE)

    def repeat(self, numbers: NDArray[np.float64], asleep: NDArray[np.int32], run: Callable[[], None]) -> None:
        """Repeat a tick after a reset of the bodies that diverged in it.

        Args:
            numbers, asleep: the state before the tick, see `engine_values.rewind`; bodies are reset to it.
            run: function that runs the tick.

        Raises:
            UnstableError: the simulation diverges even after every body has been reset.
        """
        if not self._wrong():
            return
        state, messages = self._state, dict[str, str]()
        for attempt in range(_ONE_BY_ONE + 2):
            engine_values.rewind(state, numbers, asleep)
            culprits = self._culprits()
            if not culprits:
                break
            engine_values.rewind(state, numbers, asleep)
            removals = culprits if attempt >= _ONE_BY_ONE else culprits[:1]
            for slot, what in removals:
                self._put_back(slot)
                messages[slot.frame.node.name] = what
            mujoco.mj_getState(state.model, state.data, numbers, engine_values.STATE)
            asleep[:] = state.data.tree_asleep
            engine_values.rewind(state, numbers, asleep)
            with suppress(mujoco.FatalError):  # another body diverges
                run()
            if not self._wrong():
                break
        else:
            raise UnstableError(*next(iter(messages.items())))
        for name, what in messages.items():
            self._note(name, what)

    def report(self, text: str) -> None:
        """Log an error that may occur in many ticks, at most every ten seconds of wall-clock time."""
        now = monotonic()
        if now - self._reported >= _QUIET:
            self._reported = now
            logger.error("%s", text)

    def _note(self, body: str, what: str) -> None:
        self.count += 1
        now = float(self._state.data.time)
        last = self._last.get(body, -math.inf)
        self._last[body] = now
        if now - last <= _EVENT:
            return
        self.recoveries.append(Recovery(now, body, what))
        logger.error(
            "the physics of '%s' diverged: %s. It was reset to its last valid pose, at rest; other bodies continue. "
            "Look for forces and speeds that are far too large, for bodies that start inside each other, and for "
            "masses that differ by more than 1:1000",
            body,
            what,
        )

    # -- which bodies diverged -------------------------------------------------------------------------

    def _wrong(self) -> list[tuple[Slot, str]]:
        """Return the bodies with diverged values, and a description of each."""
        data, faults = self._state.data, []
        for slot in self._state.slots:
            if slot.dof < 0:
                continue
            free = slot.frame.motion is Motion.FREE
            count, dofs = slot.numbers
            speeds = data.qvel[slot.dof : slot.dof + dofs]
            places = data.qpos[slot.qpos : slot.qpos + count]
            if not np.isfinite(places).all():
                faults.append((slot, "its position is not finite"))
            elif not np.isfinite(speeds).all():
                faults.append((slot, "its velocity is not finite"))
            elif np.abs(speeds).max() > RUNAWAY_SPEED:
                faults.append((slot, f"it moves at {np.abs(speeds).max():.3g} m/s or rad/s"))
            elif free and np.abs(places[:3]).max() > RUNAWAY_DISTANCE:
                faults.append((slot, f"it is {np.abs(places[:3]).max():.3g} m away"))
        return faults

    def _culprits(self) -> list[tuple[Slot, str]]:
        """Return the bodies that diverge first when the tick is repeated step by step, sorted by previous speed."""
        state = self._state
        model, data = state.model, state.data
        for _ in range(state.steps + 1):
            wrong = self._wrong()
            overpushed = [
                (slot, "the force on it is far too large") for slot in state.slots if self._is_overpushed(slot)
            ]
            if wrong or overpushed:
                return overpushed or wrong
            before = data.qvel.copy()
            mujoco.mj_step(model, data)
            wrong = self._wrong()
            if wrong:
                pushes = np.abs(data.xfrc_applied).max(axis=1)
                return sorted(wrong, key=lambda entry: -self._urge(entry[0], before, pushes))
        return []

    def _is_overpushed(self, slot: Slot) -> bool:
        return slot.body > 0 and not np.isfinite(self._state.data.xfrc_applied[slot.body]).all()

    def _urge(self, slot: Slot, speeds: NDArray[np.float64], pushes: NDArray[np.float64]) -> float:
        """Return the speed of a body before a step plus the speed that the forces add in the step."""
        model = self._state.model
        dofs = slot.numbers[1]
        if slot.soft:
            return float(np.abs(speeds[slot.dof : slot.dof + dofs]).max())
        mass = max(float(model.body_mass[slot.body]), 1e-9)
        speed_gain = float(pushes[slot.body]) / mass * float(model.opt.timestep)
        return float(np.abs(speeds[slot.dof : slot.dof + dofs]).max()) + speed_gain

    # -- reset -----------------------------------------------------------------------------

    def _put_back(self, slot: Slot) -> None:
        """Reset a body and its wheels to their pose before the tick; if that is lost, to their pose in the scene."""
        state = self._state
        data = state.data
        if slot.soft:
            dofs = slice(slot.dof, slot.dof + slot.soft)
            for values in (data.qvel, data.qacc_warmstart, data.qfrc_applied):
                values[dofs] = 0.0
            place = slice(slot.qpos, slot.qpos + slot.soft)
            if not np.abs(data.qpos[place]).max() <= RUNAWAY_DISTANCE:
                data.qpos[place] = state.model.qpos0[place]
            return
        index = state.slot_of[slot.frame.root.node]
        slot = state.slots[index]
        links = [state.slots[link] for link in state.links.get(index, ())]
        for link in links:
            self._stop_joints(link)
        if slot.frame.motion is not Motion.FREE:
            return
        self._gliding.unsettle(index)
        pose = data.qpos[slot.qpos : slot.qpos + 7]
        norm = float(matmul(pose[3:], pose[3:])) if np.isfinite(pose).all() else 0.0
        if not (0.25 < norm < 4.0 and np.abs(pose[:3]).max() <= RUNAWAY_DISTANCE):
            pose[:3], pose[3:] = slot.pose.position, slot.pose.quaternion
        parts = [slot, *(state.slots[wheel] for wheel in state.wheels.get(index, ()))]
        for part in parts:
            dofs = slice(part.dof, part.dof + (6 if part is slot else 1))
            for values in (data.qvel, data.qacc_warmstart, data.qfrc_applied):
                values[dofs] = 0.0
            data.xfrc_applied[part.body] = 0.0
            if part.actuator >= 0:
                data.ctrl[part.actuator] = 0.0
                if not math.isfinite(data.qpos[part.qpos]) or abs(data.qpos[part.qpos]) > RUNAWAY_DISTANCE:
                    data.qpos[part.qpos] = 0.0

    def _stop_joints(self, link: Slot) -> None:
        """Set the joints of a link to rest; a joint whose value is lost returns to its initial value."""
        data = self._state.data
        for joint in link.joints:
            for values in (data.qvel, data.qacc_warmstart, data.qfrc_applied):
                values[joint.dof : joint.dof + joint.dofs] = 0.0
            place = slice(joint.qpos, joint.qpos + joint.width)
            if not np.abs(data.qpos[place]).max() <= RUNAWAY_DISTANCE:
                data.qpos[place] = self._state.model.qpos0[place]
        data.xfrc_applied[link.body] = 0.0
