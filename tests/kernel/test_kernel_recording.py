"""Records that C encodes hold the numbers of the formulas in Python, to the bit."""

from __future__ import annotations

import math
import struct
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
import pytest

from morse.core.kinds.turning import quaternion_of
from morse.helpers.transformation import Transformation3d
from morse.kernel.recording import NativeRecords, Numbers, Poses, Rows, Scans
from morse.kernel.recording.arrays import DOUBLE, SINGLE, SUM, TURN
from morse.kernel.recording.functions import functions
from morse.mathutils.rotations import quaternion_from_rotation, rotation_from_euler
from morse.recording.captures.template import Part, Template
from morse.rosmsgs.parts import quaternion, xyzw

if TYPE_CHECKING:
    import ctypes

POSE = 56
ANGLES = (0.0, 1e-9, 0.3, -1.2, math.pi / 2, 2.5, math.pi)


@pytest.fixture(scope="module")
def rotations() -> np.ndarray:
    """(R, 2, 9): upright ones, some on their sides, some upside down."""
    turns = [rotation_from_euler(angles, "XYZ") for angles in product(ANGLES, ANGLES[:4], ANGLES)]
    return np.array(turns).reshape(-1, 2, 9)


def addresses_of(array: np.ndarray) -> np.ndarray:
    """(R,) addresses of the rows of an array, which the caller has to keep."""
    return array.ctypes.data + array.strides[0] * np.arange(len(array))


def rows_of(count: int, places: list[int]) -> tuple[Rows, Poses, np.ndarray]:
    template = Template(Part(number, bytes(8 + POSE), (4,)) for number in (1, 2))
    size = len(template.bytes)
    begins = np.arange(count, dtype=np.int64) * size
    moments = np.stack([np.arange(count) + 7, np.arange(count) * 10**9 + 5, np.arange(count) * 10**9 + 3], axis=1)
    chunk = np.zeros(count * size, dtype=np.uint8)
    rows = Rows(begins, moments.astype(np.int64), template.bytes, template.heads, template.stamps, chunk)
    rng = np.random.default_rng(1)
    mounted = np.array([rotation_from_euler((0.1, 0.2, 0.3), "XYZ")] * 2)
    positions = rng.normal(size=(count, 2, 3))
    poses = Poses(
        addresses_of(positions),
        np.zeros(count, dtype=np.int64),
        np.array([1, 0]),
        rng.normal(size=(2, 3)),
        mounted,
        np.array([0, 2], dtype=np.uint8),
        np.array(places),
    )
    return rows, poses, positions


def world_pose(poses: Poses, p: np.ndarray, r: np.ndarray, member: int) -> Transformation3d:
    slot = int(poses.slots[member])
    made = Transformation3d()
    p, r = p[slot], r[slot]
    if poses.apart[member]:
        m, t = r.reshape(3, 3), poses.turned[member].reshape(3, 3)
        o = poses.offsets[member]
        p = p + np.array([m[i, 0] * o[0] + m[i, 1] * o[1] + m[i, 2] * o[2] for i in range(3)])
        r = np.array([m[i, 0] * t[0, j] + m[i, 1] * t[1, j] + m[i, 2] * t[2, j] for i in range(3) for j in range(3)])
    made.set_pose(p.tolist(), r.tolist())
    return made


def numbers_of(position: tuple[float, ...], wxyz: tuple[float, ...]) -> bytes:
    q = quaternion(wxyz)
    return struct.pack("<7d", *position, q["x"], q["y"], q["z"], q["w"])


@pytest.mark.parametrize("what", ["poses", "frames"])
def test_poses_and_frames(build: ctypes.CDLL, what: str, rotations: np.ndarray) -> None:
    native = NativeRecords(build)
    count = len(rotations)
    template = Template(Part(number, bytes(8 + POSE)) for number in (1, 2))
    places = (template.begins + 8).tolist()
    rows, poses, positions = rows_of(count, places)
    poses = poses._replace(rotations=addresses_of(rotations))
    origin = Transformation3d()
    origin.set_pose((1.0, -2.0, 0.5), rotation_from_euler((0.2, -0.1, 2.0), "XYZ"))
    origins = np.array([[*origin.get_pose()[0], *origin.get_pose()[1]]] * 2)
    batch, lefts = native.batch(), [np.zeros((count, 2), dtype=np.uint8)]
    batch.rows(rows)
    if what == "poses":
        batch.poses(rows, poses, lefts.append)
    else:
        batch.frames(rows, poses, origins, np.array([-1, 1]), lefts.append)
    batch.run()
    left = lefts[-1]
    found, upright = rows.chunk.tobytes(), 0
    for row, member in product(range(count), range(2)):
        pose = world_pose(poses, positions[row], rotations[row], member)
        if what == "poses":
            x, y, z, yaw, pitch, roll = pose.numbers()
            assert left[row, member] == (pose.get_pose()[1][8] <= 0.51)
            wanted = numbers_of((x + 0.0, y + 0.0, z + 0.0), quaternion_of(roll, pitch, yaw))
        else:
            parent = Transformation3d()
            parent.set_pose(positions[row, 1].tolist(), rotations[row, 1].tolist())
            moved = (parent if member else origin).transformation3d_with(pose)
            assert not left[row, member]
            wanted = numbers_of(moved.get_pose()[0], quaternion_from_rotation(tuple(moved.get_pose()[1])))
        if not left[row, member]:
            begin = int(rows.begins[row]) + places[member]
            assert found[begin : begin + POSE] == wanted, (row, member)
            upright += 1
    assert upright > count // 2


def test_times_of_each_record(build: ctypes.CDLL) -> None:
    native = NativeRecords(build)
    rows, *_ = rows_of(3, [0, 0])
    batch = native.batch()
    batch.rows(rows)
    batch.run()
    size = len(rows.templates) // 2
    for number in range(6):
        head = struct.unpack_from("<BQHIQQ", rows.chunk, number * size)
        tick = number // 2
        assert head == (5, size - 9, number % 2 + 1, tick + 7, tick * 10**9 + 5, tick * 10**9 + 3)
        assert struct.unpack_from("<iI", rows.chunk, number * size + 31 + 4) == (tick, 3)


def test_scans_in_single_precision_up_to_the_reach(build: ctypes.CDLL) -> None:
    native = NativeRecords(build)
    template = Template([Part(1, bytes(4 + 8 + 4 * 4 + 4))])
    size = len(template.bytes)
    chunk = np.zeros(2 * size, dtype=np.uint8)
    begins, moments = np.array([0, size]), np.zeros((2, 3), dtype=np.int64)
    rows = Rows(begins, moments, template.bytes, template.heads, template.stamps, chunk)
    batch = native.batch()
    batch.rows(rows)
    other = [9.0] * 5
    distances = np.array([[other, [0.1, 3.9999, 4.0, math.inf, 1.0]], [other, [1e-300, 1 / 3, math.inf, 5.0, 2.0]]])
    scans = Scans(addresses_of(distances), np.array([1]), 5, 4, np.array([4.0]), np.array([31 + 12]))
    batch.scans(rows, scans)
    batch.run()
    found = [np.frombuffer(chunk, dtype="<f4", count=4, offset=begin + 43).tolist() for begin in (0, size)]
    assert found[0] == [np.float32(0.1), np.float32(3.9999), math.inf, math.inf]
    assert found[1] == [0.0, np.float32(1 / 3), math.inf, math.inf]


def test_the_functions_are_those_of_python() -> None:
    found = functions()
    assert found is not None
    for x in np.random.default_rng(2).uniform(-1.0, 1.0, 300).tolist():
        assert (found.sin(3.0 * x), found.cos(3.0 * x)) == (math.sin(3.0 * x), math.cos(3.0 * x))
        assert (found.asin(x), found.atan2(x, 0.3)) == (math.asin(x), math.atan2(x, 0.3))


def test_numbers_of_the_data_in_their_forms(build: ctypes.CDLL) -> None:
    native, rng = NativeRecords(build), np.random.default_rng(3)
    template = Template([Part(1, bytes(4 + 8 + 3 * 8 + 32))])
    size, begin = len(template.bytes), 31 + 12
    data = np.array([[0.1, -0.0, 1 / 3, *rng.normal(size=4)], [math.inf, 0.5, -1e-50, 0.0, 0.0, 0.0, 0.0]])
    which = np.array([(DOUBLE, begin, 1), (SUM, begin + 8, 1), (SINGLE, begin + 16, 2), (TURN, begin + 24, 3)])
    chunk = np.zeros(2 * size, dtype=np.uint8)
    begins, moments = np.array([0, size]), np.zeros((2, 3), dtype=np.int64)
    batch = native.batch()
    rows = Rows(begins, moments, template.bytes, template.heads, template.stamps, chunk)
    batch.rows(rows)
    batch.numbers(rows, Numbers(data, which))
    batch.run()
    for row, numbers in enumerate(data.tolist()):
        wanted = struct.pack("<ddf4x4d", numbers[1], numbers[1] + 0.0, numbers[2], *xyzw(numbers[3:]))
        at = row * size + begin
        assert chunk[at : at + 56].tobytes() == wanted
