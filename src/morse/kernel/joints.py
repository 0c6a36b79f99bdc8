"""What happens before and after the steps of the engine in rows in which motors move joints, by C functions."""

from __future__ import annotations

import ctypes
from ctypes import byref, c_double, c_int64, c_void_p
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from morse.kernel.loading import library
from morse.kernel.memory import address, addresses

if TYPE_CHECKING:
    from numpy.typing import NDArray


class _RowsStructure(ctypes.Structure):
    """``Rows`` of ``c/joints.c``."""

    _fields_ = (
        *((name, c_int64) for name in ("rows", "size")),
        *((name, c_void_p) for name in ("state", "before")),
        *((name, c_int64) for name in ("positions", "places", "speeds", "dofs", "motors")),
        *((name, c_void_p) for name in ("contacts", "warnings")),
        ("kinds", c_int64),
        ("most", c_void_p),
        *((name, c_double) for name in ("farthest", "fastest")),
        ("most_objects", c_int64),
        ("objects", c_void_p),
        ("slip", c_double),
        *((name, c_void_p) for name in ("going", "missed", "last", "ticks", "rates", "origins", "times")),
        *((name, c_int64) for name in ("groups", "most_free")),
        *((name, c_void_p) for name in ("free_groups", "free_places", "alone", "at", "turned", "lowest")),
        *((name, c_void_p) for name in ("normalize", "matrix")),
    )


class _MotorsStructure(ctypes.Structure):
    """``Motors`` of ``c/joints.c``."""

    _fields_ = (
        ("joints", c_int64),
        *(
            (name, c_void_p)
            for name in (
                "targets", "goals", "values", "targets_before", "values_before", "low", "high", "steps", "channels"
            )
        ),
    )  # fmt: skip


class _GatheredStructure(ctypes.Structure):
    """``Gathered`` of ``c/joints.c``."""

    _fields_ = (("count", c_int64), ("places", c_void_p), ("data", c_void_p))


class Sizes(NamedTuple):
    """Where numbers are in a state of the engine.

    Attributes:
        size: all of them.
        positions, places: the first one, and their number; also of speeds.
        motors: the first command.
    """

    size: int
    positions: int
    places: int
    speeds: int
    dofs: int
    motors: int


class JointRows:
    """N rows with states of the same sizes.

    Args:
        rows: N.
        groups: number of rigid groups, K.
        free, objects: largest numbers of free bodies of a row, F, and of those whose contacts change while they slide,
            M.
        limits: of the norms of all positions and of all speeds, beyond which a row is removed; and the speed of an
            object that slides, m/s.
        functions: addresses of ``mju_normalize4`` and ``mju_quat2Mat``.

    Attributes:
        going: (N,) the rows that take part; the functions remove those in which something has happened that the world
            itself has to deal with.
        before: (N, size) states before the last call.
        positions, rotations: (N, K, 3) m, (N, K, 9) poses of the groups.
        free_groups, free_places: (N, F) the free bodies of a row, and their positions in the engine; -1 for none.
        objects: (N, M) numbers in a state: the speeds of objects that may slide; -1 for none.
        alone: (N,) whether `settle` computes the poses of these.
        most, lowest: (N,) limits of the number of contacts, and of the height of free bodies, m.
        missed, last: (N,) ticks before the last call, and those of it.
        ticks, rates, origins: (N,) ticks before these, Hz, and the time of tick 0, s.
        times: (N,) s.
    """

    def __init__(
        self,
        rows: int,
        groups: int,
        free: int,
        objects: int,
        sizes: Sizes,
        limits: tuple[float, float, float],
        functions: tuple[int, int],
    ) -> None:
        self.sizes = sizes
        self.going, self.alone = np.zeros(rows, bool), np.zeros(rows, bool)
        self.before = np.zeros((rows, sizes.size))
        self.positions, self.rotations = np.zeros((rows, groups, 3)), np.zeros((rows, groups, 9))
        self.free_groups, self.free_places = (np.full((rows, free), -1, np.int64) for _ in range(2))
        self.objects = np.full((rows, objects), -1, np.int64)
        self.most, self.missed, self.last, self.ticks = (np.zeros(rows, np.int64) for _ in range(4))
        self.lowest, self.origins, self.times = (np.zeros(rows) for _ in range(3))
        self.rates = np.ones(rows)
        farthest, fastest, slip = limits
        self._all = _RowsStructure(
            rows=rows,
            size=sizes.size,
            before=address(self.before),
            positions=sizes.positions,
            places=sizes.places,
            speeds=sizes.speeds,
            dofs=sizes.dofs,
            motors=sizes.motors,
            most=address(self.most),
            farthest=farthest**2,
            fastest=fastest**2,
            most_objects=objects,
            objects=address(self.objects),
            slip=slip,
            going=address(self.going),
            missed=address(self.missed),
            last=address(self.last),
            ticks=address(self.ticks),
            rates=address(self.rates),
            origins=address(self.origins),
            times=address(self.times),
            groups=groups,
            most_free=free,
            free_groups=address(self.free_groups),
            free_places=address(self.free_places),
            alone=address(self.alone),
            at=address(self.positions),
            turned=address(self.rotations),
            lowest=address(self.lowest),
            normalize=functions[0],
            matrix=functions[1],
        )
        self.place = byref(self._all)
        self._keep: tuple[NDArray[np.generic], ...] = ()
        kernel = library()
        self._begin, self._check, self._settle = (
            kernel.morse_joints_begin,
            kernel.morse_joints_check,
            kernel.morse_joints_settle,
        )
        self._begin.argtypes, self._begin.restype = (c_void_p, c_int64), None
        self._check.argtypes = self._settle.argtypes = (c_void_p, c_int64)
        self._check.restype = self._settle.restype = None

    def use(self, state: NDArray[np.float64], contacts: NDArray[np.int32], warnings: NDArray[np.int32]) -> None:
        """Use arrays of the engine: (N, size) the present states, (N,), (N, W, 2)."""
        self._keep = state, contacts, warnings
        self._all.state, self._all.contacts, self._all.warnings = addresses(state, contacts, warnings)
        self._all.kinds = warnings.shape[1]

    def begin(self, ticks: int) -> None:
        """Begin a call of some ticks: keep the states from before it; rows in which an object slides are removed."""
        self._begin(self.place, ticks)

    def check(self, *, is_last: bool) -> None:
        """Look at the states after a tick of a call; rows that the world itself has to deal with are removed."""
        self._check(self.place, is_last)

    def settle(self, ticks: int) -> None:
        """End a call: compute poses and times; rows in which a free body has left the world are removed."""
        self._settle(self.place, ticks)


class Motors:
    """The setpoints of the motors of an actuator in all rows, (N, J) each.

    Attributes:
        targets, values: setpoints, and to which the last tick has moved the joints.
        targets_before, values_before: the same before the last call.
        low, high, steps: limits of the setpoints, and what a tick changes at most.
        channels: numbers of the motors; -1 for a joint without motor.
    """

    def __init__(self, rows: JointRows, joints: int) -> None:
        shape = len(rows.going), joints
        self._rows = rows
        self.targets, self._goals, self.values = (np.zeros(shape) for _ in range(3))
        self.targets_before, self.values_before, self.low, self.high = (np.zeros(shape) for _ in range(4))
        self.steps, self.channels = np.full(shape, np.inf), np.full(shape, -1, np.int64)
        arrays = self.targets, self._goals, self.values, self.targets_before, self.values_before
        limits = self.low, self.high, self.steps, self.channels
        self._all = _MotorsStructure(joints, *map(address, (*arrays, *limits)))
        self._place = byref(self._all)
        kernel = library()
        self._keep, self._tell, self._act = kernel.morse_joints_keep, kernel.morse_joints_tell, kernel.morse_joints_act
        self._keep.argtypes = self._act.argtypes = (c_void_p, c_void_p)
        self._tell.argtypes = (c_void_p, c_void_p, c_void_p, c_int64, c_void_p, c_int64, c_void_p)
        self._keep.restype = self._tell.restype = self._act.restype = None

    def begin(self) -> None:
        """Keep the setpoints from before a call."""
        self._keep(self._rows.place, self._place)

    def tell(self, rows: NDArray[np.int64], joints: NDArray[np.int64], values: NDArray[np.float64]) -> None:
        """Take commands (N, F), contiguous, for F joints of those of some rows, (M,), that take part."""
        count = len(joints)
        self._tell(self._rows.place, self._place, address(rows), len(rows), address(joints), count, address(values))

    def act(self) -> None:
        """Move the joints toward their setpoints by one tick."""
        self._act(self._rows.place, self._place)

    def limit(self, row: int) -> None:
        """Take note of targets or limits of a row that were set in the arrays."""
        target, low, high = self.targets[row], self.low[row], self.high[row]
        self._goals[row] = np.where(target < low, low, np.where(target > high, high, target))


class Gathered:
    """Numbers of the states that become data.

    Args:
        data: (N, F), contiguous.

    Attributes:
        places: (N, F) numbers in a state; -1 for the time.
    """

    def __init__(self, rows: JointRows, data: NDArray[np.float64]) -> None:
        self._rows, self._data = rows, data
        self.places = np.full(data.shape, -1, np.int64)
        self._all = _GatheredStructure(data.shape[1], address(self.places), address(data))
        self._place = byref(self._all)
        self._gather = library().morse_joints_gather
        self._gather.argtypes, self._gather.restype = (c_void_p, c_void_p), None

    def update(self) -> None:
        """Copy the numbers of the rows that take part."""
        self._gather(self._rows.place, self._place)
