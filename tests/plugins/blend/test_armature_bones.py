"""Armatures of model files become trees of joints."""

import math
from pathlib import Path

import numpy as np
import pytest

import morse
from morse.helpers.chain import Chain
from morse.plugins.blend import read_blend
from morse.scene import JointKind

ARM = Path(morse.__file__).parent / "data" / "actuators" / "kuka_lwr.blend"


@pytest.fixture(scope="module")
def arm():
    return next(node for node in read_blend(ARM).nodes() if node.bones)


def test_bones_have_names_lengths_and_order(arm):
    assert [bone.name for bone in arm.bones] == [f"kuka_{i}" for i in range(1, 8)]
    assert [bone.parent for bone in arm.bones] == [-1, 0, 1, 2, 3, 4, 5]
    assert [bone.length for bone in arm.bones] == pytest.approx([0.3105, 0.2, 0.2, 0.2, 0.19, 0.078, 0.132], abs=1e-6)


def test_joints_have_axes_and_limits(arm):
    for number, bone in enumerate(arm.bones, 1):
        assert bone.kind is JointKind.REVOLUTE
        limit = math.radians(170.0 if number % 2 else 120.0)
        assert bone.axis == (1 if number % 2 else 2)
        assert (bone.low, bone.high) == pytest.approx((-limit, limit), abs=1e-5)
        assert bone.value == 0.0


def test_frames_are_upright_and_end_at_the_tip(arm):
    chain = Chain(arm.bones)
    frames = chain.frames(chain.start)
    heights = [frame[0][2] for frame in frames]
    assert heights == pytest.approx([0.0, 0.3105, 0.5105, 0.7105, 0.9105, 1.1005, 1.1785], abs=1e-6)
    assert chain.tip(frames[-1], 6)[0] == pytest.approx((0.0, 0.0, 1.3105), abs=1e-6)
    for _, rotation in frames:
        # the Y axis along the bone, and a rotation
        assert rotation[1::3] == pytest.approx((0.0, 0.0, 1.0), abs=1e-6)
        matrix = np.reshape(rotation, (3, 3))
        assert np.allclose(matrix @ matrix.T, np.eye(3), atol=1e-12)


def test_parts_hang_on_their_bones(arm):
    held = {node.name: node.bone for node in arm.children}
    assert held == {**{f"kuka_{i}": f"kuka_{i}" for i in range(1, 8)}, "kuka_base": ""}


def test_an_armature_of_twice_the_size_reaches_twice_as_far(arm):
    chain = Chain(arm.bones, 2.0)
    assert chain.tip(chain.frames(chain.start)[-1], 6)[0] == pytest.approx((0.0, 0.0, 2.621), abs=1e-6)
