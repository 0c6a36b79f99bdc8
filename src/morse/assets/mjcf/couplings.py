"""The tendons and constraints of an MJCF model."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np

from morse.scene.couplings import Constraint, ConstraintKind, Couplings, Tendon, TendonMotor, Wrap, WrapKind

if TYPE_CHECKING:
    from collections.abc import Mapping

_WRAPS = {2: WrapKind.PULLEY, 3: WrapKind.SITE, 4: WrapKind.SPHERE, 5: WrapKind.CYLINDER, 1: WrapKind.JOINT}
_CONSTRAINTS = {
    int(mujoco.mjtEq.mjEQ_CONNECT): ConstraintKind.CONNECT,
    int(mujoco.mjtEq.mjEQ_WELD): ConstraintKind.WELD,
    int(mujoco.mjtEq.mjEQ_JOINT): ConstraintKind.JOINT,
    int(mujoco.mjtEq.mjEQ_TENDON): ConstraintKind.TENDON,
}


class CouplingReader:
    """Reads the couplings of a compiled model.

    Args:
        links: body to the name of its link; bodies that are left out are missing.
        joints: joint to the name of its bone; likewise.
        handled: constraints that are joints that follow others.

    Attributes:
        lost: what is left out, one sentence each.
    """

    def __init__(
        self, model: mujoco.MjModel, links: Mapping[int, str], joints: Mapping[int, str], handled: frozenset[int]
    ) -> None:
        self._model, self._links, self._joints, self._handled = model, links, joints, handled
        self.lost: list[str] = []

    def read(self) -> Couplings:
        """Return the couplings of the links and joints that are not left out."""
        m = self._model
        tendons = {index: tendon for index in range(m.ntendon) if (tendon := self._tendon(index)) is not None}
        names = {index: tendon.name for index, tendon in tendons.items()}
        motors = (self._motor(index, names) for index in range(m.nu))
        constraints = (self._constraint(index, names) for index in range(m.neq) if index not in self._handled)
        return Couplings(
            tuple(tendons.values()),
            tuple(motor for motor in motors if motor is not None),
            tuple(constraint for constraint in constraints if constraint is not None),
        )

    def _name(self, kind: object, index: int, word: str) -> str:
        return mujoco.mj_id2name(self._model, kind, index) or f"{word}{index}"

    # -- tendons ---------------------------------------------------------------------------

    def _tendon(self, index: int) -> Tendon | None:
        m = self._model
        name = self._name(mujoco.mjtObj.mjOBJ_TENDON, index, "tendon")
        start = int(m.tendon_adr[index])
        path = [self._wrap(number) for number in range(start, start + int(m.tendon_num[index]))]
        wraps = tuple(wrap for wrap in path if wrap is not None)
        if len(wraps) != len(path):
            self.lost.append(f"the tendon '{name}' is left out: it runs over parts that are left out")
            return None
        solver = (*_row(m.tendon_solref_lim[index]), *_row(m.tendon_solimp_lim[index]))
        limits = _row(m.tendon_range[index])
        rest = _row(m.tendon_lengthspring[index])
        return Tendon(
            name,
            wraps,
            (limits[0], limits[1]) if m.tendon_limited[index] else None,
            float(np.ravel(m.tendon_stiffness[index])[0]),
            float(np.ravel(m.tendon_damping[index])[0]),
            float(m.tendon_frictionloss[index]),
            (rest[0], rest[1]),
            float(m.tendon_armature[index]),
            solver,
        )

    def _wrap(self, number: int) -> Wrap | None:
        m = self._model
        kind, place, value = _WRAPS.get(int(m.wrap_type[number])), int(m.wrap_objid[number]), float(m.wrap_prm[number])
        if kind is WrapKind.PULLEY:
            return Wrap(kind, value=value)
        if kind is WrapKind.JOINT:
            name = self._joints.get(place)
            return None if name is None else Wrap(kind, name, value)
        if kind is WrapKind.SITE:
            link = self._links.get(int(m.site_bodyid[place]))
            return None if link is None else Wrap(kind, link, position=_row(m.site_pos[place]))
        if kind is None:
            return None
        link = self._links.get(int(m.geom_bodyid[place]))
        side = None
        if value >= 0.0:
            holder = self._links.get(int(m.site_bodyid[int(value)]))
            side = None if holder is None else (holder, _row(m.site_pos[int(value)]))
        if link is None:
            return None
        radius = float(m.geom_size[place][0])
        return Wrap(kind, link, radius, _row(m.geom_pos[place]), _row(m.geom_quat[place]), side)

    def _motor(self, index: int, tendons: Mapping[int, str]) -> TendonMotor | None:
        m = self._model
        tendon = int(m.actuator_trnid[index][0])
        if int(m.actuator_trntype[index]) != int(mujoco.mjtTrn.mjTRN_TENDON) or tendon not in tendons:
            return None
        name = self._name(mujoco.mjtObj.mjOBJ_ACTUATOR, index, "actuator")
        while name in self._joints.values():
            # both are fields of the armature
            name += "_tendon"
        affine = int(m.actuator_biastype[index]) == int(mujoco.mjtBias.mjBIAS_AFFINE)
        none = int(m.actuator_biastype[index]) == int(mujoco.mjtBias.mjBIAS_NONE)
        direct = int(m.actuator_dyntype[index]) == int(mujoco.mjtDyn.mjDYN_NONE)
        fixed = int(m.actuator_gaintype[index]) == int(mujoco.mjtGain.mjGAIN_FIXED)
        if not (fixed and direct and (affine or none)):
            self.lost.append(f"the motor '{name}' of a tendon has dynamics of its own; it is left out")
            return None
        bias = _row(m.actuator_biasprm[index]) if affine else (0.0, 0.0, 0.0)
        low, high = _row(m.actuator_ctrlrange[index]) if m.actuator_ctrllimited[index] else (-np.inf, np.inf)
        force = float(abs(m.actuator_forcerange[index]).max()) if m.actuator_forcelimited[index] else np.inf
        return TendonMotor(
            name,
            tendons[tendon],
            float(m.actuator_gear[index][0]),
            float(m.actuator_gainprm[index][0]),
            (bias[0], bias[1], bias[2]),
            (float(low), float(high)),
            force,
        )

    # -- constraints -----------------------------------------------------------------------

    def _constraint(self, index: int, tendons: Mapping[int, str]) -> Constraint | None:
        m = self._model
        kind = _CONSTRAINTS.get(int(m.eq_type[index]))
        word = mujoco.mjtEq(int(m.eq_type[index])).name.removeprefix("mjEQ_").lower()
        if kind is None:
            self.lost.append(f"a constraint '{word}' is left out")
            return None
        ends = [int(m.eq_obj1id[index]), int(m.eq_obj2id[index])]
        if kind in (ConstraintKind.CONNECT, ConstraintKind.WELD):
            if int(m.eq_objtype[index]) == int(mujoco.mjtObj.mjOBJ_SITE):
                return self._between_sites(index, kind, ends)
            names: Mapping[int, str] = self._links
        else:
            names = self._joints if kind is ConstraintKind.JOINT else tendons
        one, other = names.get(ends[0]), "" if ends[1] < 0 else names.get(ends[1])
        if one is None or other is None:
            self.lost.append(f"a constraint '{word}' is left out: it concerns parts that are left out")
            return None
        return self._made(index, kind, one, other, _row(m.eq_data[index]))

    def _between_sites(self, index: int, kind: ConstraintKind, sites: list[int]) -> Constraint | None:
        """A constraint of two sites as one of the links that carry them."""
        m = self._model
        one, other = (self._links.get(int(m.site_bodyid[site])) for site in sites)
        if one is None or other is None:
            self.lost.append(f"a constraint '{kind}' is left out: it concerns parts that are left out")
            return None
        first, second = (_row(m.site_pos[site]) for site in sites)
        data = _row(m.eq_data[index])
        if kind is ConstraintKind.CONNECT:
            return self._made(index, kind, one, other, (*first, *second, *data[6:]))
        a, b = (np.array(m.site_quat[site], dtype=np.float64) for site in sites)
        back, rotation = np.zeros(4), np.zeros(4)
        mujoco.mju_negQuat(back, b)
        mujoco.mju_mulQuat(rotation, a, back)
        return self._made(index, kind, one, other, (*second, *first, *_row(rotation), *data[10:]))

    def _made(self, index: int, kind: ConstraintKind, one: str, other: str, data: tuple[float, ...]) -> Constraint:
        m = self._model
        solver = (*_row(m.eq_solref[index]), *_row(m.eq_solimp[index]))
        return Constraint(kind, one, other, data, solver, bool(m.eq_active0[index]))


def _row(values: Any) -> tuple[float, ...]:
    return tuple(float(value) for value in values)
