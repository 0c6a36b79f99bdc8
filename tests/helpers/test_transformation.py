import copy
import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from morse.helpers.transformation import Transformation3d
from morse.mathutils import Euler, Matrix, Vector


class Body:
    """An object with the attributes that components of users use."""

    def __init__(self, position=(0, 0, 0), roll=0.0, pitch=0.0, yaw=0.0):
        self.worldPosition = Vector(position)
        self.worldOrientation = Euler((roll, pitch, yaw)).to_matrix()


class QuickBody(Body):
    """An object that provides its pose as numbers."""

    def world_pose(self):
        return tuple(self.worldPosition), tuple(value for row in self.worldOrientation for value in row)


metres = st.floats(-1e3, 1e3)
turns = st.floats(-math.pi, math.pi)
bodies = st.builds(
    lambda kind, position, roll, pitch, yaw: kind(position, roll, pitch, yaw),
    st.sampled_from([Body, QuickBody]), st.tuples(metres, metres, metres), turns, turns, turns,
)  # fmt: skip


def matrix_of(body):
    return np.array(Matrix.LocRotScale(body.worldPosition, body.worldOrientation, None))


def test_without_an_object_there_is_no_displacement():
    pose = Transformation3d()
    assert (pose.x, pose.y, pose.z, pose.yaw, pose.pitch, pose.roll) == (0.0,) * 6
    assert pose.matrix == Matrix()


@pytest.mark.parametrize("kind", [Body, QuickBody])
def test_position_and_angles(kind):
    pose = Transformation3d(kind((1, 2, 3), 0.1, -0.2, 2.5))
    assert (pose.x, pose.y, pose.z) == (1.0, 2.0, 3.0)
    assert (pose.roll, pose.pitch, pose.yaw) == pytest.approx((0.1, -0.2, 2.5), abs=1e-12)
    assert tuple(pose.euler) == pytest.approx((0.1, -0.2, 2.5), abs=1e-12)
    assert pose.translation == Vector((1, 2, 3))
    assert tuple(pose.rotation) == pytest.approx(tuple(Euler((0.1, -0.2, 2.5)).to_quaternion()))
    assert "x=1.0000, y=2.0000, z=3.0000, yaw=2.5000" in repr(pose)


def test_set_pose_takes_numbers():
    pose = Transformation3d()
    pose.set_pose((1.0, 2.0, 3.0), (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0))
    assert (pose.x, pose.y, pose.z) == (1.0, 2.0, 3.0)
    assert pose.yaw == pytest.approx(math.pi / 2)
    assert pose.rotation_matrix == Matrix(((0, -1, 0), (1, 0, 0), (0, 0, 1)))


def test_a_pose_stays_when_the_object_moves_on():
    body = Body((1, 2, 3))
    pose = Transformation3d(body)
    body.worldPosition[0] = 9.0
    body.worldOrientation[0][0] = -1.0
    assert pose.x == 1.0
    assert pose.yaw == 0.0
    kept = copy.copy(pose)
    pose.update(body)
    assert pose.x == 9.0
    assert kept.x == 1.0


def test_what_is_returned_does_not_change_the_pose():
    pose = Transformation3d(Body((1, 2, 3)))
    pose.translation.x = 7
    pose.matrix.invert()
    pose.euler.z = 1
    assert pose.x == 1.0
    assert pose.yaw == 0.0


def test_copies():
    pose = Transformation3d(Body((1, 2, 3), 0.1, 0.2, 0.3))
    for twin in (copy.copy(pose), copy.deepcopy(pose), pickle.loads(pickle.dumps(pose))):
        assert twin.matrix == pose.matrix


def test_distances():
    a, b = Transformation3d(Body((1, 2, 3))), Transformation3d(Body((4, 6, 15)))
    assert a.distance(b) == 13.0
    assert a.distance_2d(b) == 5.0


@given(bodies)
def test_angles_compose_to_the_rotation(body):
    pose = Transformation3d(body)
    again = Euler((pose.roll, pose.pitch, pose.yaw)).to_matrix()
    assert np.allclose(again, body.worldOrientation, atol=1e-7)
    assert pose.numbers() == (pose.x, pose.y, pose.z, pose.yaw, pose.pitch, pose.roll)
    assert tuple(pose.euler) == (pose.roll, pose.pitch, pose.yaw)


def size(angles):
    return sum(map(abs, angles))


@given(turns, turns, turns)
def test_of_the_two_solutions_the_one_with_the_smaller_sum_is_reported(roll, pitch, yaw):
    given_angles = [math.remainder(angle, math.tau) for angle in (roll, pitch, yaw)]
    other = [math.remainder(angle, math.tau) for angle in (roll + math.pi, math.pi - pitch, yaw + math.pi)]
    pose = Transformation3d(Body((0, 0, 0), *given_angles))
    assert size((pose.roll, pose.pitch, pose.yaw)) <= min(size(given_angles), size(other)) + 1e-6


@given(turns)
def test_a_pure_pitch_comes_back_as_a_pure_pitch(pitch):
    pose = Transformation3d(Body((0, 0, 0), 0.0, pitch, 0.0))
    assert (pose.yaw, pose.roll) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert math.remainder(pose.pitch - pitch, math.tau) == pytest.approx(0.0, abs=1e-6)


@given(st.sampled_from([-1, 1]), turns, turns, st.floats(0, 1e-5))
def test_angles_are_valid_in_and_near_gimbal_lock(side, roll, yaw, off):
    body = Body((0, 0, 0), roll, side * (math.pi / 2 - off), yaw)
    pose = Transformation3d(body)
    again = Euler((pose.roll, pose.pitch, pose.yaw)).to_matrix()
    assert np.allclose(again, body.worldOrientation, atol=1e-6)


def test_rounding_beyond_one_is_a_pitch_of_a_quarter_turn():
    pose = Transformation3d()
    pose.set_pose((0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0000000000000002, 0.0, 0.0))
    assert pose.pitch == pytest.approx(math.pi / 2)
    assert (pose.roll, pose.yaw) == (0.0, 0.0)


@given(bodies, bodies)
def test_relative_pose_is_inverse_times_other(a, b):
    relative = Transformation3d(a).transformation3d_with(Transformation3d(b))
    assert np.allclose(matrix_of(a) @ np.array(relative.matrix), matrix_of(b), atol=1e-8)
    assert np.allclose(relative.matrix, np.linalg.inv(matrix_of(a)) @ matrix_of(b), atol=1e-8)
