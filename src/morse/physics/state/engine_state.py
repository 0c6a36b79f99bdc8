"""The state of the engine and the poses of all slots, and what its steps do beside the engine."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import mujoco
import numpy as np

from morse.mathutils.portable import norm
from morse.physics.engine_functions import Sleep
from morse.physics.model.layout import Motion
from morse.physics.poses.kinematics import Flexes, Rows

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from numpy.typing import NDArray

    from morse.physics.model.articulated import JointSlot
    from morse.physics.model.compile import Compiled
    from morse.physics.model.files import FileMotor
    from morse.physics.model.layout import Slot
    from morse.scene import Node

#: m/s; beyond the second one, bodies have diverged
SLIP = 0.25
_DIVERGED = 1e6
#: contacts with a larger time constant, in steps, are soft on purpose
_STIFF = 3.0
#: rates of robots and slips of their wheels that are none, rad/s and m/s; solutions of the contacts that slide
_TURNS, _CREEP, _SOLUTIONS = 0.02, 0.005, 3
#: bodies that bounce rest below the speed that gravity adds in so many steps
_RESTING_STEPS = 2.0
#: factors for the contacts of bodies that bounce: they do not give way, but these are lifted out of each other slowly,
#: since the speed would be that of a bounce
_HARDER, _SOFTER = 1e3, 1e2
#: dimensions of a contact that resists sliding alone
_PLAIN = 3


class Sliding:
    """Changes the contacts of objects that slide.

    Args:
        slots: the objects of the model.

    Attributes:
        dofs: (M, 3) numbers of their linear speeds in the engine.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, slots: Iterable[Slot]) -> None:
        self._model, self._data = model, data
        objects = [slot for slot in slots if slot.frame.motion is Motion.FREE and slot.frame.robot is None]
        free = [slot.body for slot in objects if slot.body > 0]
        self._bodies = np.array([body for body in free if model.body_dofnum[body] == 6], dtype=np.intp)
        self.dofs = model.body_dofadr[self._bodies][:, None] + np.arange(3)
        elliptic = model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
        self.has_objects = bool(len(self._bodies)) and bool(elliptic)
        self._slides = np.zeros(model.nbody, dtype=bool)
        self._geom_body = np.asarray(model.geom_bodyid)
        self._longest = _STIFF * model.opt.timestep
        self.is_needed = False

    def begin(self) -> None:
        """Note at the beginning of a tick which objects slide: each for itself, whatever the others do."""
        fast = self._fast()
        self.is_needed = bool(fast.any())
        if self.is_needed:
            self._slides[self._bodies] = fast

    def may_begin(self) -> bool:
        """Whether objects slide now."""
        return bool(self._fast().any())

    def _fast(self) -> NDArray[np.bool_]:
        return np.asarray(np.abs(self._data.qvel[self.dofs]).max(axis=1) > SLIP)

    def change(self) -> None:
        """Limit the change of the slip that the contacts of sliding objects ask for."""
        data, contact = self._data, self._data.contact
        rows = contact.efc_address
        chosen = self._slides[self._geom_body[contact.geom]].any(axis=1) & (rows >= 0) & (contact.dim > 2)
        chosen &= contact.solref[:, 0] <= self._longest
        if not chosen.any():
            return
        first = rows[chosen]
        # bodies that diverge are dealt with elsewhere
        near, along, across = (np.clip(data.efc_vel[first + row], -_DIVERGED, _DIVERGED) for row in range(3))
        slip = np.sqrt(along * along + across * across)
        share = np.minimum(1.0, (SLIP + np.abs(near)) / np.maximum(slip, SLIP))
        data.efc_aref[first + 1] *= share
        data.efc_aref[first + 2] *= share


class SurfaceMotion:
    """Lets the surfaces of kinematic bodies move while the bodies stand still, as belts do.

    Friction acts against the slip, which is measured from the moving surface: the engine asks for a change of speed
    along each row of a contact, and the speed of the surface along that row is subtracted before.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        self._model, self._data = model, data
        #: (nbody, 6) linear velocity of the origin, m/s, and angular velocity, rad/s, world axes
        self._twists = np.zeros((model.nbody, 6))
        self._geom_body = np.asarray(model.geom_bodyid)
        self._elliptic = model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
        self.is_needed = False

    def set(self, bodies: NDArray[np.intp], twists: NDArray[np.float64]) -> None:
        """Set the twists (N, 6) of the surfaces of bodies."""
        self._twists[bodies] = twists
        self.is_needed = bool(self._twists.any())

    def begin(self) -> None:
        """The tick begins: what moves is known."""

    def may_begin(self) -> bool:
        """Always: they move in the tick for which they are set."""
        return True

    def change(self) -> None:
        """Measure the slip of contacts from the moving surfaces."""
        data, contact = self._data, self._data.contact
        pairs = self._geom_body[contact.geom]
        chosen = np.flatnonzero(
            (self._twists[pairs].any(axis=2)).any(axis=1) & (contact.efc_address >= 0) & (contact.dim > 1)
        )
        if not len(chosen):
            return
        dims, first, frames = contact.dim[chosen], contact.efc_address[chosen], contact.frame[chosen].reshape(-1, 3, 3)
        pairs, places = pairs[chosen], contact.pos[chosen]
        # of the second shape relative to the first one, as the engine counts
        twists = self._twists[pairs[:, 1]] - self._twists[pairs[:, 0]]
        linear, angular = twists[:, :3], twists[:, 3:]
        for side, sign in ((0, -1.0), (1, 1.0)):
            wx, wy, wz = self._twists[pairs[:, side], 3:].T
            x, y, z = (places - data.xpos[pairs[:, side]]).T
            linear += sign * np.stack((wy * z - wz * y, wz * x - wx * z, wx * y - wy * x), axis=1)
        # along the two tangents; if the contact resists it, about the normal and about the tangents
        speeds = (frames[:, 1:] * linear[:, None]).sum(axis=2)
        if dims.max() > _PLAIN:
            speeds = np.concatenate([speeds, (frames * angular[:, None]).sum(axis=2)], axis=1)
        for direction in range(int(dims.max()) - 1):
            has_it = dims > direction + 1
            row, speed = first[has_it], speeds[has_it, direction]
            if self._elliptic:
                self._add(row + 1 + direction, speed)
            else:
                # the rows of a pyramid are pairs: the normal direction and a share of the tangent, both ways
                share = contact.friction[chosen][has_it, direction] * speed
                self._add(row + 2 * direction, share)
                self._add(row + 2 * direction + 1, -share)

    def _add(self, rows: NDArray[np.intp], speeds: NDArray[np.float64]) -> None:
        data = self._data
        data.efc_vel[rows] += speeds
        data.efc_aref[rows] -= data.efc_KBIP[rows, 1] * speeds


class WheelFriction:
    """Lets wheels of robots from files slide sideways as Coulomb's law says.

    The engine relaxes this law: a contact whose slip does not end in a step gets a speed along its normal, μ times as
    large as the slip that is left. A wheel that slides sideways hops, and the robot turns by what the hops leave. De
    Saxcé's correction subtracts this speed from what the normal asks for, and a few solutions find both (V. Acary et
    al., "A formulation of the linear discrete Coulomb friction problem via convex optimization", ZAMM 91, 2011). The
    first guess is the slip at the beginning of the step, which most steps keep. Otherwise, the loads of six wheels,
    which do not follow from the weight alone, would stay those of the relaxed law.

    The contacts of all wheels of a robot are equally stiff, so that wheels between others bear no more than these.

    Args:
        geoms: the shapes of wheels.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, geoms: Sequence[int]) -> None:
        self._model, self._data = model, data
        self._is_wheel = np.zeros(model.ngeom, dtype=bool)
        self._is_wheel[list(geoms)] = model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC
        self.has_wheels = bool(self._is_wheel.any())
        trees = model.body_rootid[model.geom_bodyid[self._is_wheel]]
        self._turns = np.unique(model.body_dofadr[trees] + 5)
        bodies = model.geom_bodyid[self._is_wheel]
        for tree in np.unique(trees):
            # by which the engine scales the stiffness of contacts
            model.body_invweight0[bodies[trees == tree]] = model.body_invweight0[bodies[trees == tree]].mean(axis=0)
        self.is_needed = False

    def begin(self) -> None:
        """Note at the beginning of a tick whether a robot turns."""
        if self.has_wheels:
            self.is_needed = bool((np.abs(self._data.qvel[self._turns]) > _TURNS).any())

    def may_begin(self) -> bool:
        """Always: wheels begin to turn within a tick."""
        return True

    def change(self) -> None:
        """Correct what the normals of wheels that slide ask for in this step."""
        model, data, contact = self._model, self._data, self._data.contact
        chosen = self._is_wheel[contact.geom].any(axis=1) & (contact.efc_address >= 0) & (contact.dim == 3)
        first = contact.efc_address[chosen]
        slides = _length(data.efc_vel[first + 1], data.efc_vel[first + 2]) > _CREEP
        first, friction = first[slides], contact.friction[chosen, 0][slides]
        if not len(first):
            return
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fwdAcceleration(model, data)
        asked, along = data.efc_aref[first], np.zeros(data.nefc)
        data.efc_aref[first] = asked - friction * _length(data.efc_aref[first + 1], data.efc_aref[first + 2])
        for _ in range(_SOLUTIONS):
            mujoco.mj_fwdConstraint(model, data)
            mujoco.mj_mulJacVec(model, data, along, data.qacc)
            left = along - data.efc_aref
            data.efc_aref[first] = asked - friction * _length(left[first + 1], left[first + 2])


def _length(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.sqrt(x * x + y * y))


class Impacts:
    """Reflects bodies that bounce by Newton's law: the speed after an impact is that before it, times the restitution.

    The law holds in the one step of the engine in which shapes begin to overlap. Both speeds are those at the surface,
    which the body crosses within the step: with the acceleration a, the gap x and the speed v at the beginning of a
    step, the engine moves the body along the parabola of the speed u = v + a dt / 2, which is sqrt(u² - 2 a x) at the
    surface. So heights depend neither on the step nor on the time of the impact within it.

    Slower approaches than what gravity adds in some steps are contacts at rest.

    Args:
        restitution: (ngeom,) of each shape, from 0 to 1; negative for those that have none.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, restitution: NDArray[np.float64]) -> None:
        self._model, self._data, self._of_geom = model, data, restitution
        self.is_needed = bool((restitution >= 0.0).any())
        self._step = float(model.opt.timestep)
        self._resting = _RESTING_STEPS * self._step * norm(model.opt.gravity) + 1e-3
        self._elliptic = model.opt.cone == mujoco.mjtCone.mjCONE_ELLIPTIC

    def begin(self) -> None:
        """Shapes that bounce do so in all ticks."""

    def may_begin(self) -> bool:
        """Always: who touches what is known within the tick."""
        return True

    def change(self) -> None:
        """Set what the contacts of shapes that bounce ask for in this step."""
        data, contact = self._data, self._data.contact
        of_both = self._of_geom[contact.geom]
        # of two that bounce, the one that bounces less
        ratios = np.where((of_both >= 0.0).all(axis=1), of_both.min(axis=1), of_both.max(axis=1))
        chosen = np.flatnonzero((ratios >= 0.0) & (contact.efc_address >= 0))
        if not len(chosen):
            return
        first, sizes = contact.efc_address[chosen], contact.dim[chosen]
        if not self._elliptic:
            # the rows of a pyramid have the normal direction and one along the surface, forwards and backwards
            sizes = np.maximum(2 * (sizes - 1), 1)
        owners = np.repeat(np.arange(len(chosen)), sizes)
        rows = np.arange(len(owners)) + (first - np.cumsum(sizes) + sizes)[owners]
        # what the constraints ask for is done, whatever shares the load
        data.efc_D[rows] *= _HARDER
        data.efc_R[rows] /= _HARDER
        if data.nisland:
            # the engine has copied the rows of its islands
            copies = data.map_efc2iefc[rows]
            data.iefc_D[copies], data.iefc_R[copies] = data.efc_D[rows], data.efc_R[rows]
        stiffness, damping, impedance = data.efc_KBIP[first, :3].T
        # more damping would reverse the speed
        data.efc_aref[rows] *= np.minimum(1.0, 1.0 / (damping * self._step))[owners]
        damping = np.minimum(damping, 1.0 / self._step)
        if self._elliptic:
            owners, rows = np.arange(len(chosen)), first
        speeds, gaps = data.efc_vel[rows], data.efc_pos[first]
        speed = np.bincount(owners, speeds) / np.bincount(owners)
        wanted = -stiffness * impedance * gaps / _SOFTER - damping * speed
        wanted[speed > self._resting] = -_DIVERGED
        hits = np.flatnonzero(speed < -self._resting)
        if len(hits):
            free = np.bincount(owners, self._free_acceleration()[rows]) / np.bincount(owners)
            after = self._speed_after(ratios[chosen[hits]], speed[hits], gaps[hits], free[hits])
            wanted[hits] = (after - speed[hits]) / self._step
        data.efc_aref[rows] = wanted[owners] - damping[owners] * (speeds - speed[owners])

    def _free_acceleration(self) -> NDArray[np.float64]:
        """The acceleration (nefc,) along each row without constraints."""
        mujoco.mj_fwdActuation(self._model, self._data)
        mujoco.mj_fwdAcceleration(self._model, self._data)
        along = np.zeros(self._data.nefc)
        mujoco.mj_mulJacVec(self._model, self._data, along, self._data.qacc_smooth)
        return along

    def _speed_after(
        self,
        ratio: NDArray[np.float64],
        speed: NDArray[np.float64],
        gap: NDArray[np.float64],
        acceleration: NDArray[np.float64],
    ) -> NDArray[np.float64]:
        """The speeds at the end of the step, m/s."""
        half = 0.5 * acceleration * self._step
        before = speed + half
        # a body that was put into another one has not fallen that far
        gap = np.maximum(gap, -np.abs(before) * self._step)
        squared = np.maximum(before * before - 2.0 * acceleration * gap, 0.0)
        after: NDArray[np.float64] = half + np.sqrt(np.maximum(ratio * ratio * squared + 2.0 * acceleration * gap, 0.0))
        return after


class Change(Protocol):
    """Changes contacts in each step of the engine."""

    is_needed: bool

    def begin(self) -> None:
        """Find out at the beginning of a tick whether it `is_needed`."""

    def may_begin(self) -> bool:
        """Whether it may be needed in a tick that begins now."""

    def change(self) -> None:
        """Change the contacts of this step."""


class Steps(Protocol):
    """Observes the steps of the engine; see `morse.physics.touches.Touches`."""

    def before_step(self) -> None:
        """The steps of the tick begin, or are repeated."""

    def run(self, steps: int) -> None:
        """Run steps of the engine."""


class EngineState:
    """A compiled scene and the values that change while it runs.

    Rigid groups of nodes share a *slot*. Slots that the engine moves come first, so that slot ``k`` is MuJoCo body
    ``k + 1``.

    Attributes:
        model, data: the MuJoCo model and state; only this package touches them.
        sleep: sets which trees of bodies sleep.
        slots: indices of each rigid group in the arrays of the engine.
        slot_of: index of the slot of each node.
        wheels: slot of a robot to the slots of its wheels.
        links: slot of a body to all slots that joints attach to it.
        attached: slot of a body to its wheels and links.
        joints: armature to its joints by name.
        whole: slot of a robot from a file to all of its bodies in the engine.
        file_motors: actuators of MJCF files that are not motors of single joints.
        geom_node: node of each geom.
        link_bodies: the body of each link of MJCF files, in the engine.
        planes: the geoms of boxes to those of the planes at their tops.
        flexes: the deformable bodies; None if there are none.
        physics_of_1_4: whether driven robots lose speed as in MORSE 1.4 (`morse.physics.driving.command`).
        steps: physics steps per tick.
        period: seconds per tick.
        moving: number of slots that the engine moves.
        engine_positions, engine_rotations: present poses of these slots in the engine; of all bodies, if they are not
            its first ones.
        engine_rows: bodies of these slots, or None if they are the first bodies.
        compiled_poses: positions (N, 3), rotations (N, 9) and quaternions of all slots in the scene, once they are
            needed.
        by_hand: slots that are only moved by explicit calls, because they have neither joints nor shapes.
        poses_before: positions (K, 3) and rotations (K, 9) of these slots at the beginning of the last tick of
            `morse.physics.gliding.passage.FreeRun`, which overwrites them.
        stamp: changes whenever an object has moved.
        displacements: changes whenever an object was moved within its slot.
        positions: position of each slot, [x, y, z] in m, world frame.
        rotations: rotation of each slot, 9 row-major numbers.
        quaternions: w, x, y, z of each slot that was moved by an explicit call; of the other slots, at the start.
        touched: slots that were moved by explicit calls since the last forward kinematics of the engine.
        loose: static slots with shapes that were moved by explicit calls.
        relocated: all static slots that were moved by explicit calls since the last reset or restored state.
        rearranged: nodes whose shapes moved within their slots since the last ray cast.
        kinematic: linear and angular velocity, world axes, of slots that move kinematically in this tick.
        placed: linear and angular velocity, world axes, of slots that explicit calls have placed.
        has_forces: whether forces or torques are set for the next tick.
        is_stirred: whether a body that does not glide was changed by an explicit call since the last tick.
        has_gaps: whether the engine may report contacts within a gap around a shape.
        known_contacts: (N, 2) geoms in contact at the end of a tick; None until somebody asks for those of the engine.
        names: name of the first node of each slot; ``named`` maps it to the slot.
        watch: runs the steps and observes them; None if nobody does.
        write_gliders: writes the poses of the robots that glide into ``positions`` and ``rotations``.
        changes: what may change contacts in this model.
    """

    watch: Steps | None = None
    write_gliders: Callable[[Rows, Rows], None] | None = None

    #: what lets surfaces move in the next tick
    _surfaces: SurfaceMotion | None

    def __init__(self, compiled: Compiled, period: float) -> None:
        self.take(compiled, period)

    def run(self, steps: int) -> None:
        """Run steps of the engine, and observe them."""
        if self.watch is None:
            self.take_steps(steps)
        else:
            self.watch.run(steps)

    def take_steps(self, steps: int) -> None:
        """Run steps of the engine."""
        changes = [one.change for one in self.changes if one.is_needed]
        if not changes:
            mujoco.mj_step(self.model, self.data, steps)
            return
        for _ in range(steps):
            mujoco.mj_step1(self.model, self.data)
            if self.data.ncon:
                for change in changes:
                    change()
            mujoco.mj_step2(self.model, self.data)

    def move_surfaces(self, bodies: NDArray[np.intp], twists: NDArray[np.float64]) -> None:
        """Let the surfaces of bodies move in the next tick with twists (N, 6)."""
        if self._surfaces is None:
            # the other changes read the slip from the moving surfaces
            self._surfaces = SurfaceMotion(self.model, self.data)
            self.changes.insert(0, self._surfaces)
        self._surfaces.set(bodies, twists)

    def rest_surfaces(self) -> None:
        """The tick is over."""
        if self._surfaces is not None:
            self.changes.remove(self._surfaces)
            self._surfaces = None

    def take(self, compiled: Compiled, period: float) -> None:
        """Use a compiled model, with all poses from the scene."""
        self.write_gliders = None
        self.model: mujoco.MjModel = compiled.model
        self.data: mujoco.MjData = compiled.data
        self.sleep = Sleep(self.model, self.data)
        self.slots: list[Slot] = compiled.slots
        self._surfaces = None
        self.sliding = Sliding(self.model, self.data, self.slots)
        self.impacts = Impacts(self.model, self.data, compiled.restitution)
        self.wheel_friction = WheelFriction(self.model, self.data, compiled.wheels)
        may_change = self.sliding.has_objects, self.impacts.is_needed, self.wheel_friction.has_wheels
        every: tuple[Change, ...] = self.sliding, self.impacts, self.wheel_friction
        self.changes: list[Change] = [one for one, may in zip(every, may_change, strict=True) if may]
        self.geom_node: list[Node] = compiled.geom_node
        self.link_bodies: dict[Node, int] = compiled.link_bodies
        self.planes: dict[int, int] = compiled.planes
        self.flexes = Flexes(self.model, compiled.flexes) if compiled.flexes else None
        self.physics_of_1_4 = compiled.physics_of_1_4
        self.steps = compiled.steps
        self.period = period
        self.moving = sum(1 for slot in self.slots if slot.body > 0 and slot.frame.motion is not Motion.FIXED)
        self.engine_positions, self.engine_rotations = self.data.xpos, self.data.xmat
        self.engine_rows: NDArray[np.intp] | None = np.array(
            [slot.body for slot in self.slots[: self.moving]], dtype=np.intp
        )
        if np.array_equal(self.engine_rows, np.arange(1, self.moving + 1)):
            self.engine_positions = self.engine_positions[1 : self.moving + 1]
            self.engine_rotations = self.engine_rotations[1 : self.moving + 1]
            self.engine_rows = None
        self.slot_of: dict[Node, int] = {
            node: index for index, slot in enumerate(self.slots) for node in slot.frame.members
        }
        self.wheels: dict[int, list[int]] = {}
        for index, slot in enumerate(self.slots):
            if slot.frame.motion is Motion.HINGE and slot.frame.parent is not None:
                self.wheels.setdefault(self.slot_of[slot.frame.parent.node], []).append(index)
        self.links: dict[int, list[int]] = {}
        self.joints: dict[Node, dict[str, JointSlot]] = {}
        for index, slot in enumerate(self.slots):
            for joint in slot.joints:
                self.joints.setdefault(joint.armature, {})[joint.name] = joint
            outer = slot.frame.parent if slot.frame.motion is Motion.JOINT else None
            while outer is not None:
                self.links.setdefault(self.slot_of[outer.node], []).append(index)
                outer = outer.parent
        self.attached = {
            index: (*self.wheels.get(index, ()), *self.links.get(index, ())) for index in {*self.wheels, *self.links}
        }
        roots, trees = self.model.body_rootid, dict[int, list[int]]()
        for body in range(1, self.model.nbody):
            trees.setdefault(int(roots[body]), []).append(body)
        self.whole: dict[int, tuple[int, ...]] = {
            index: tuple(trees[slot.body])
            for index, slot in enumerate(self.slots)
            if slot.frame.motion is Motion.FREE and len(trees.get(slot.body, ())) > 1 and index not in self.wheels
        }
        self.has_gaps = bool(self.model.geom_gap.any())
        self.by_hand = tuple(
            index for index in range(self.moving, len(self.slots)) if self.slots[index].frame.motion is not Motion.FIXED
        )
        self.file_motors: list[FileMotor] = compiled.file_motors
        self.poses_before = np.zeros((self.moving, 3)), np.zeros((self.moving, 9))
        self.stamp = 0
        self.displacements = 0
        self.compiled_poses: tuple[NDArray[np.float64], NDArray[np.float64], list[Sequence[float]]] = (
            np.zeros((0, 3)),
            np.zeros((0, 9)),
            [],
        )
        self.positions, self.rotations = Rows(np.zeros((0, 3))), Rows(np.zeros((0, 9)))
        self.quaternions: list[Sequence[float]] = []
        self.touched: set[int] = set()
        self.loose: set[int] = set()
        self.relocated: set[int] = set()
        self.rearranged: set[Node] = set()
        self.kinematic: dict[int, tuple[Sequence[float], Sequence[float]]] = {}
        self.placed: dict[int, tuple[Sequence[float], Sequence[float]]] = {}
        self.has_forces = False
        self.is_stirred = True
        self.known_contacts: NDArray[np.int32] | None = None
        self.names = tuple(slot.frame.node.name for slot in self.slots)
        self.named = {name: index for index, name in enumerate(self.names)}
