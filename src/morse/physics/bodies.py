"""Sets poses, velocities and forces of bodies."""

from __future__ import annotations

import math
from struct import Struct
from typing import TYPE_CHECKING, cast

import mujoco
import numpy as np

from morse.mathutils.portable import matmul, norm
from morse.physics.engine_functions import count_weightless, wake
from morse.physics.gliding import glide_velocity
from morse.physics.model.layout import Motion
from morse.physics.poses import rigid
from morse.physics.poses.convert import FORCE, POSITION, VELOCITY
from morse.physics.poses.kinematics import settle_fixed
from morse.scene import PhysicsType, ShapeKind

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from morse.physics.gliding.gliding import Gliding
    from morse.physics.model.layout import Slot
    from morse.physics.objects.object_world import Posed
    from morse.physics.state.engine_state import EngineState
    from morse.scene import CollisionShape, Node

#: m; larger than the distance of any shape from its body
_FAR = 1e6


class MovedShapes:
    """Bodies whose shapes have moved within them.

    The engine finds pairs of shapes that may touch with a tree of bounding boxes, which it never updates. For a body
    whose shapes have moved, the boxes are made so large that every pair of shapes is tested.
    """

    def __init__(self, state: EngineState) -> None:
        self._state = state
        self._boxes: dict[int, NDArray[np.float64]] = {}

    def note(self, body: int) -> None:
        """Enlarge the boxes of a body whose shapes have moved."""
        if body in self._boxes:
            return
        model = self._state.model
        start, count = int(model.body_bvhadr[body]), int(model.body_bvhnum[body])
        rows = slice(start, start + count)
        if count:
            self._boxes[body] = model.bvh_aabb[rows].copy()
            model.bvh_aabb[rows] = (0.0, 0.0, 0.0, _FAR, _FAR, _FAR)

    def reset(self) -> None:
        """Restore the boxes, because all shapes are at their compiled poses."""
        model = self._state.model
        for body, boxes in self._boxes.items():
            start = int(model.body_bvhadr[body])
            model.bvh_aabb[start : start + len(boxes)] = boxes
        self._boxes.clear()


class KinematicBodies:
    """Bodies that explicit calls move; see `morse.core.world.KinematicBodies`.

    Raises:
        ValueError: one of them is no such body.
    """

    def __init__(self, state: EngineState, objects: Sequence[Posed]) -> None:
        for obj in objects:
            kind = obj.node.body.type
            if kind is not PhysicsType.KINEMATIC:
                raise ValueError(f"'{obj.node.name}' is not a kinematic body: its physics type is {kind}")
        self._state, self._objects = state, objects
        self._take()

    def _take(self) -> None:
        """Look up the places of the bodies, which change when objects are added or removed."""
        state = self._state
        for obj in self._objects:
            if obj.node not in state.slot_of:
                raise LookupError(f"'{obj.node.name}' has been removed from the world")
        self._model, indices = state.model, [obj.slot for obj in self._objects]
        self._indices = np.array(indices, dtype=np.intp)
        self._rows = [row for row, index in enumerate(indices) if state.slots[index].mocap >= 0]
        self._mocap = np.array([state.slots[indices[row]].mocap for row in self._rows], dtype=np.intp)

    def place(
        self,
        positions: NDArray[np.float64],
        quaternions: NDArray[np.float64],
        velocities: NDArray[np.float64] | None = None,
    ) -> None:
        """See `morse.core.world.KinematicBodies`."""
        state, count = self._state, len(self._indices)
        if state.model is not self._model:
            self._take()
        p, q = np.asarray(positions, dtype=np.float64), np.asarray(quaternions, dtype=np.float64)
        if p.shape != (count, 3) or q.shape != (count, 4):
            raise ValueError(f"expected positions ({count}, 3) and quaternions ({count}, 4), got {p.shape}, {q.shape}")
        lengths = np.sqrt((q * q).sum(axis=1))
        if not (np.abs(p) <= POSITION.limit).all() or not (np.isfinite(lengths) & (lengths > 0.0)).all():
            raise ValueError(f"positions are at most {POSITION.limit:g} m, quaternions are not 0, and both are finite")
        if velocities is not None:
            told = np.asarray(velocities, dtype=np.float64)
            if told.shape != (count, 3) or not (np.abs(told) <= VELOCITY.limit).all():
                raise ValueError(f"velocities are ({count}, 3) and at most {VELOCITY.limit:g} m/s, got {told.shape}")
            state.placed.update(zip(self._indices.tolist(), ((one, _STILL[:3]) for one in told.tolist()), strict=True))
        q = q / lengths[:, None]
        w, x, y, z = q.T
        rotations = np.stack(
            (
                *(1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
                *(2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
                *(2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
            ),
            axis=1,
        )
        state.positions.put(self._indices, p)
        state.rotations.put(self._indices, rotations)
        for index, quaternion in zip(self._indices.tolist(), q.tolist(), strict=True):
            state.quaternions[index] = quaternion
        if self._rows:
            state.is_stirred = True
            state.data.mocap_pos[self._mocap], state.data.mocap_quat[self._mocap] = p[self._rows], q[self._rows]
            state.touched.update(self._indices[self._rows].tolist())
        state.stamp += 1

    def move_surfaces(self, linear: NDArray[np.float64], angular: NDArray[np.float64]) -> None:
        """See `morse.core.world.KinematicBodies`."""
        if self._state.model is not self._model:
            self._take()
        twists = np.concatenate([np.asarray(linear, dtype=np.float64), np.asarray(angular, dtype=np.float64)], axis=-1)
        if twists.shape != (len(self._indices), 6) or not (np.abs(twists) <= VELOCITY.limit).all():
            raise ValueError(
                f"expected two arrays ({len(self._indices)}, 3) of at most {VELOCITY.limit:g}, got {twists.shape}"
            )
        if self._rows:
            bodies = [self._state.slots[self._indices[row]].body for row in self._rows]
            self._state.move_surfaces(np.array(bodies, dtype=np.intp), twists[self._rows])


#: a few numbers of the engine are written in this way in a third of the time that an array takes
_THREE, _POSE, _BYTES = Struct("=3d"), Struct("=7d"), 8
_STILL = (0.0,) * 6
_AT_REST = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))


class Bodies:
    """Operations on single bodies from outside the engine; a gliding robot stops gliding first."""

    def __init__(self, state: EngineState, gliding: Gliding) -> None:
        self._state = state
        self._gliding = gliding
        # views that are kept: the engine creates a new view at each access, which takes longer than its use
        self._qpos, self._qvel = state.data.qpos, state.data.qvel
        self._applied = cast("memoryview[float]", memoryview(state.data.xfrc_applied.reshape(-1)))
        self.masses = cast("memoryview[float]", memoryview(state.model.body_mass))
        self.moved_shapes = MovedShapes(state)

    # -- poses -----------------------------------------------------------------------------

    def place(self, index: int, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Set the pose of a slot in the world; its velocity is unchanged."""
        state = self._state
        slot, data = state.slots[index], state.data
        if slot.frame.motion in (Motion.HINGE, Motion.JOINT):
            return
        state.is_stirred = True
        self._gliding.unsettle(index)
        p, q = position, rigid.quaternion(rotation)
        if slot.frame.motion is Motion.FREE and slot.qpos >= 0:
            _POSE.pack_into(self._qpos, _BYTES * slot.qpos, p[0], p[1], p[2], *q)
        elif slot.mocap >= 0:
            data.mocap_pos[slot.mocap] = p
            data.mocap_quat[slot.mocap] = q
        elif slot.body == 0:
            self._move_static(index, position, rotation)
            self._settle_fixed(index)
        elif slot.body > 0:
            state.model.body_pos[slot.body] = p
            state.model.body_quat[slot.body] = q
            self._settle_fixed(index)
        state.positions[index], state.rotations[index], state.quaternions[index] = tuple(position), tuple(rotation), q
        state.touched.add(index)
        if slot.frame.motion is Motion.FIXED:
            state.relocated.add(index)
        state.stamp += 1
        slots = state.attached.get(index, ())
        if slots:
            mujoco.mj_kinematics(state.model, data)
        for other in slots:
            state.touched.add(other)
            state.positions[other] = data.xpos[state.slots[other].body].tolist()
            state.rotations[other] = data.xmat[state.slots[other].body].tolist()

    def put_back(
        self, index: int, position: Sequence[float], rotation: Sequence[float], offset_rotation: Sequence[float]
    ) -> None:
        """Set the pose of a slot again after the engine has moved it; slots below it follow with the next sync.

        Args:
            offset_rotation: the rotation as a quaternion w, x, y, z.
        """
        state = self._state
        slot = state.slots[index]
        if slot.frame.motion in (Motion.HINGE, Motion.JOINT) or slot.soft:
            return
        if slot.qpos >= 0:
            state.is_stirred = True
            self._gliding.unsettle(index)
            _POSE.pack_into(self._qpos, _BYTES * slot.qpos, *position, *offset_rotation)
            glide_velocity.put(self._qvel, slot.dof, _STILL)
        elif slot.mocap >= 0:
            state.is_stirred = True
            state.data.mocap_pos[slot.mocap] = position
            state.data.mocap_quat[slot.mocap] = offset_rotation
        else:
            return
        state.positions[index], state.rotations[index], state.quaternions[index] = position, rotation, offset_rotation

    def _move_static(self, index: int, position: Sequence[float], rotation: Sequence[float]) -> None:
        """Move shapes that belong to the world."""
        state, model = self._state, self._state.model
        before = state.positions[index], state.rotations[index]
        for geoms in state.slots[index].geoms.values():
            for geom in geoms:
                turned = rigid.rotation_of_quaternion(model.geom_quat[geom].tolist())
                local = rigid.relative(*before, model.geom_pos[geom].tolist(), turned)
                place, turned = rigid.compose(position, rotation, *local)
                model.geom_pos[geom], model.geom_quat[geom] = place, rigid.quaternion(turned)
        self.moved_shapes.note(0)

    def _settle_fixed(self, index: int) -> None:
        self._gliding.floor_changed(index)
        settle_fixed(self._state)
        self._state.loose.add(index)

    def move_shapes(self, node: Node, offset: tuple[Sequence[float], Sequence[float]]) -> None:
        """Move the collision shapes of a node after the node moved within its body.

        Args:
            offset: position and rotation of the node in its slot.
        """
        state = self._state
        index = state.slot_of[node]
        slot = state.slots[index]
        if node not in slot.geoms or slot.frame.motion is Motion.HINGE:
            return
        state.is_stirred = True
        self._gliding.leave(index)
        for geom, shape in zip(slot.geoms[node], node.shapes or (), strict=True):
            position, rotation = rigid.compose(*offset, *self.shape_pose(geom, shape))
            if slot.body == 0:
                position, rotation = rigid.compose(state.positions[index], state.rotations[index], position, rotation)
            state.model.geom_pos[geom] = position
            state.model.geom_quat[geom] = rigid.quaternion(rotation)
        if slot.body >= 0:
            self.moved_shapes.note(slot.body)
            wake(state, slot.body)
        self._gliding.note_moved_shapes(index, slot.geoms[node])
        if slot.frame.motion is Motion.FIXED:
            self._settle_fixed(index)
        state.rearranged.add(node)
        state.stamp += 1

    def shapes_have_moved(
        self, index: int, geoms: Sequence[int], nodes: Sequence[Node], reach: float, lowest: float
    ) -> None:
        """Record that shapes of a slot were moved within it, see `morse.physics.objects.linkage`.

        Args:
            reach: distance from the origin of the slot to the outermost point of its shapes, m.
            lowest: height of the lowest point of the moved shapes above the origin of the slot, m.
        """
        state = self._state
        slot = state.slots[index]
        if not self._gliding.goes_on(index, geoms, reach, lowest):
            state.is_stirred = True
        if slot.body >= 0:
            self.moved_shapes.note(slot.body)
            wake(state, slot.body)
        if slot.frame.motion is Motion.FIXED:
            self._settle_fixed(index)
        state.rearranged.update(nodes)

    def shape_pose(self, geom: int, shape: CollisionShape) -> tuple[Sequence[float], Sequence[float]]:
        """Return position and rotation of a shape in the frame of its node."""
        if shape.kind is not ShapeKind.CONVEX:
            return shape.position, shape.rotation
        # the compiler moves hulls to their centre of mass and principal axes
        model = self._state.model
        mesh = model.geom_dataid[geom]
        return (
            model.mesh_pos[mesh].tolist(),
            rigid.rotation_of_quaternion(model.mesh_quat[mesh].tolist()),
        )

    # -- velocities and forces -------------------------------------------------------------

    def velocity(self, index: int) -> tuple[Sequence[float], Sequence[float]]:
        """Return the linear (m/s) and angular (rad/s) velocity of the origin of a slot, both in world axes."""
        state = self._state
        slot = state.slots[index]
        if slot.frame.motion is Motion.FREE and slot.dof >= 0:
            vx, vy, vz, *rates = glide_velocity.read(self._qvel, slot.dof)
            return (vx, vy, vz), rigid.turn(state.rotations[index], rates)
        if slot.frame.motion is Motion.HINGE:
            return self._hinge_velocity(index, slot)
        if slot.frame.motion is Motion.JOINT:
            return self._link_velocity(index, slot)
        if state.flexes is not None and index in state.flexes:
            return state.flexes.velocity(state, index), _AT_REST[1]
        return state.kinematic.get(index) or state.placed.get(index, _AT_REST)

    def _hinge_velocity(self, index: int, slot: Slot) -> tuple[Sequence[float], Sequence[float]]:
        state = self._state
        assert slot.frame.parent is not None
        robot = state.slot_of[slot.frame.parent.node]
        linear, angular = self.velocity(robot)
        arm = np.subtract(state.positions[index], state.positions[robot]).tolist()
        axle = rigid.turn(state.rotations[index], state.model.jnt_axis[state.model.body_jntadr[slot.body]].tolist())
        speed = float(state.data.qvel[slot.dof])
        carried = rigid.cross(angular, arm)
        # the wheel rotates about its own origin
        return (
            tuple(a + b for a, b in zip(linear, carried, strict=True)),
            tuple(a + speed * b for a, b in zip(angular, axle, strict=True)),
        )

    def _link_velocity(self, index: int, slot: Slot) -> tuple[Sequence[float], Sequence[float]]:
        state = self._state
        model, data = state.model, state.data
        assert slot.frame.parent is not None
        outer = state.slot_of[slot.frame.parent.node]
        carried, turning = self.velocity(outer)
        place = np.array(state.positions[index])
        angular = np.array(turning, dtype=np.float64)
        linear = np.array(carried) + np.cross(angular, place - np.array(state.positions[outer]))
        for joint in slot.joints:
            number = int(model.dof_jntid[joint.dof])
            if joint.width == 4:
                along = matmul(data.xmat[slot.body].reshape(3, 3), data.qvel[joint.dof : joint.dof + 3])
                angular = angular + along
                linear += np.cross(along, place - data.xanchor[number])
                continue
            along = float(data.qvel[joint.dof]) * data.xaxis[number]
            if model.jnt_type[number] == mujoco.mjtJoint.mjJNT_SLIDE:
                linear += along
            else:
                angular = angular + along
                linear += np.cross(along, place - data.xanchor[number])
        return linear.tolist(), angular.tolist()

    def set_velocity(self, index: int, linear: Sequence[float] | None, angular: Sequence[float] | None) -> None:
        """Set the velocity of a free slot, in world axes; slots that are not free are unchanged."""
        state = self._state
        slot, qvel = state.slots[index], self._qvel
        if slot.frame.motion is not Motion.FREE or slot.dof < 0:
            return
        state.is_stirred = True
        self._gliding.leave(index)
        if linear is not None:
            _THREE.pack_into(qvel, _BYTES * slot.dof, *linear)
        if angular is not None:
            _THREE.pack_into(qvel, _BYTES * (slot.dof + 3), *rigid.turn_back(state.rotations[index], angular))

    def balance_spin(self, index: int, angular: Sequence[float]) -> None:
        """Apply the torque that keeps a body turning about a commanded axis, which need not be a principal one.

        Args:
            angular: rad/s about the axes of the body.
        """
        body, model = self._state.slots[index].body, self._state.model
        axes = rigid.rotation_of_quaternion(model.body_iquat[body].tolist())
        p, q, r = rigid.turn(rigid.transpose(axes), angular)
        a, b, c = model.body_inertia[body].tolist()
        own = rigid.turn(axes, (q * r * (c - b), r * p * (a - c), p * q * (b - a)))
        self.apply_wrench(index, (0.0, 0.0, 0.0), rigid.turn(self._state.rotations[index], own))

    def apply_wrench(self, index: int, force: Sequence[float], torque: Sequence[float]) -> None:
        """Apply a force (N) and a torque (N m) at the centre of mass during the next tick, world axes."""
        state = self._state
        slot = state.slots[index]
        if slot.body > 0:
            state.is_stirred = True
            self._gliding.leave(index)
            applied, first = self._applied, 6 * slot.body
            (x, y, z), (about_x, about_y, about_z) = force, torque
            applied[first] += x
            applied[first + 1] += y
            applied[first + 2] += z
            applied[first + 3] += about_x
            applied[first + 4] += about_y
            applied[first + 5] += about_z
            state.has_forces = True

    def set_added_mass(self, index: int, mass: Sequence[float], inertia: Sequence[float]) -> None:
        """Set the mass of the fluid that moves along with a free body; see `morse.core.world.Body.set_added_mass`.

        The engine has no coupling of the axes: the mass along an axis of the world is the mean of those along the axes
        of the body, weighted by the squares of the direction cosines.
        """
        state = self._state
        slot = state.slots[index]
        if slot.frame.motion is not Motion.FREE or slot.body <= 0:
            return
        a, b, c, d, e, f, g, h, i = state.rotations[index]
        x, y, z = mass
        added = (
            *(a * a * x + b * b * y + c * c * z, d * d * x + e * e * y + f * f * z, g * g * x + h * h * y + i * i * z),
            *inertia,
        )
        model, dofs = state.model, slice(slot.dof, slot.dof + 6)
        model.dof_armature[dofs] = added
        if model.body_simple[slot.body]:
            # the engine takes the constant inertia of a simple body
            own = (*(model.body_mass[slot.body],) * 3, *model.body_inertia[slot.body])
            model.dof_M0[dofs] = np.add(own, added)

    def pull(
        self,
        index: int,
        anchor: Sequence[float],
        target: Sequence[float],
        stiffness: float,
        damping: float,
        strongest: float,
    ) -> None:
        """Pull a point of a body, ``anchor`` in world coordinates, towards a target; only dynamic bodies are pulled.

        See `GameObject.pull`.
        """
        state = self._state
        slot = state.slots[index]
        if slot.frame.motion not in (Motion.FREE, Motion.JOINT) or slot.body < 0:
            return
        linear, angular = self.velocity(index)
        speed = np.add(linear, np.cross(angular, np.subtract(anchor, state.positions[index])))
        wanted = stiffness * np.subtract(target, anchor) - damping * speed
        size = float(norm(wanted))
        mass = float(state.model.body_subtreemass[slot.body])
        strongest = min(strongest, FORCE.limit / mass)
        if not size < math.inf:
            return
        if size > strongest:
            wanted *= strongest / size
        force = mass * wanted
        # the lever is reduced, so that a large body does not spin fast when it is pulled at its rim
        centre = rigid.turn(state.rotations[index], state.model.body_ipos[slot.body].tolist())
        lever = np.subtract(anchor, np.add(state.positions[index], centre))
        torque = 0.3 * np.cross(lever, force)
        self.apply_wrench(index, force.tolist(), torque.tolist())

    # -- collision and gravity -------------------------------------------------------------

    def set_collision(self, nodes: Sequence[Node], active: bool) -> None:
        """Enable or disable the collisions of the shapes of nodes."""
        state = self._state
        state.is_stirred = True
        for node in nodes:
            index = state.slot_of[node]
            slot = state.slots[index]
            self._gliding.leave(index)
            self._gliding.set_collision([*slot.geoms.get(node, ()), *slot.feet], active)
            if slot.frame.motion is Motion.FIXED:
                self._gliding.floor_changed(index)

    def is_weightless(self, index: int) -> bool:
        """Whether gravity is cancelled for a slot."""
        state = self._state
        return bool(state.model.body_gravcomp[state.slots[index].body] == 1.0)

    def set_weightless(self, index: int) -> None:
        """Cancel gravity for a slot."""
        state = self._state
        model, data = state.model, state.data
        body = state.slots[index].body
        state.is_stirred = True
        self._gliding.leave(index)
        if body <= 0 or model.body_gravcomp[body] == 1.0:
            return
        model.body_gravcomp[body] = 1.0
        count_weightless(state)
        mujoco.mj_forward(model, data)
        state.known_contacts = None
