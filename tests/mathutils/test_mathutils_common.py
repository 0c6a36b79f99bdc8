"""Common behaviour of all types: copies, pickles, freezing, text, and the sequence protocol."""

import copy
import json
import math
import pickle
from collections.abc import Sequence

import msgspec
import numpy as np
import pytest

from morse.core import mathutils
from morse.mathutils import Color, Euler, Matrix, Quaternion, Vector

SAMPLES = [
    Vector((1, 2, 3)),
    Vector((1, 2)),
    Euler((0.1, 0.2, 0.3), "ZXY"),
    Quaternion((0.5, 0.5, 0.5, 0.5)),
    Color((0.1, 0.2, 0.3)),
    Matrix(((1, 2, 3), (4, 5, 6))),
]
everything = pytest.mark.parametrize("sample", SAMPLES, ids=repr)


def test_components_find_them_in_the_core():
    assert mathutils.Euler([0.1, 0, 0]).to_matrix() == Euler((0.1, 0, 0)).to_matrix()
    assert mathutils.Vector is Vector


@everything
@pytest.mark.parametrize(
    "duplicate", [copy.copy, copy.deepcopy, lambda x: x.copy(), lambda x: pickle.loads(pickle.dumps(x))]
)
def test_copies_are_equal_and_independent(sample, duplicate):
    twin = duplicate(sample)
    assert twin == sample
    assert type(twin) is type(sample)
    twin[0] = twin[1] * 0 if isinstance(twin, Matrix) else 99.0
    assert twin != sample


@everything
def test_they_are_sequences(sample):
    assert isinstance(sample, Sequence)
    assert len(sample) == len(list(sample)) == len(np.array(sample))
    assert bool(sample)


def test_json_encoders_take_their_items():
    assert json.dumps(list(Vector((1, 2, 3)))) == "[1.0, 2.0, 3.0]"
    assert msgspec.json.encode(Vector((1, 2, 3)), enc_hook=list) == b"[1.0,2.0,3.0]"


@everything
def test_freezing(sample):
    thing = sample.copy()
    with pytest.raises(TypeError, match="unhashable"):
        hash(thing)
    assert thing.freeze() is thing
    assert thing.is_frozen
    assert {thing: 1}[thing.copy().freeze()] == 1
    assert thing == sample
    with pytest.raises(TypeError):
        thing[0] = thing[1]
    assert not thing.copy().is_frozen
    assert thing == sample


def test_a_frozen_vector_refuses_every_change():
    v = Vector((1, 2, 3)).freeze()
    for change in (v.normalize, v.negate, v.zero, v.resize_2d, lambda: v.__iadd__(v), lambda: v.__setitem__(0, 5.0)):
        with pytest.raises(TypeError, match="frozen"):
            change()
    m = Matrix().freeze()
    for change in (m.invert, m.zero, m.transpose):
        with pytest.raises(TypeError, match="frozen"):
            change()
    assert v == Vector((1, 2, 3))


def test_types_never_equal_one_another_or_tuples():
    assert Vector((1, 2, 3)) != Euler((1, 2, 3))
    assert Vector((1, 2, 3)) != (1, 2, 3)
    assert Vector((1, 2, 3)) != Vector((1, 2))
    assert Vector((1, 2, 3, 4)) != Quaternion((1, 2, 3, 4))
    assert Matrix() != Matrix.Identity(3)


def test_text_is_blenders():
    assert repr(Vector((1, 2, 3))) == "Vector((1.0000, 2.0000, 3.0000))"
    assert repr(Euler((1, 2, 3))) == "Euler((1.0000, 2.0000, 3.0000), 'XYZ')"
    assert repr(Quaternion()) == "Quaternion((1.0000, 0.0000, 0.0000, 0.0000))"
    assert repr(Matrix(((1, 2), (3, 4)))) == "Matrix(((1.0000, 2.0000), (3.0000, 4.0000)))"
    assert repr(Color()) == "Color((0.0000, 0.0000, 0.0000))"


@everything
def test_text_can_be_read_back(sample):
    assert eval(repr(sample)) == sample


def test_not_a_number_is_taken_as_given():
    assert math.isnan(Vector((math.nan, 0, 0)).length)
    assert math.isnan(Euler((math.nan, 0, 0)).to_matrix()[1][1])


def test_no_stray_attributes():
    for sample in SAMPLES:
        with pytest.raises(AttributeError):
            sample.wrong = 1


def test_colours():
    c = Color((1, 0.5, 0))
    assert (c.r, c.g, c.b) == (1.0, 0.5, 0.0)
    assert c.h == pytest.approx(30 / 360)
    assert (c.s, c.v) == (1.0, 1.0)
    c.hsv = (2 / 3, 1.0, 0.5)
    assert tuple(c) == pytest.approx((0.0, 0.0, 0.5))
    c.h = 1 / 3
    assert tuple(c) == pytest.approx((0.0, 0.5, 0.0))
    c.s = 0.5
    c.v = 1.0
    assert tuple(c) == pytest.approx((0.5, 1.0, 0.5))
    c.r, c.g, c.b = 0.1, 0.2, 0.3
    assert c + c == c * 2 == 2 * c
    assert tuple(c - c) == (0.0, 0.0, 0.0)
    assert tuple(c / 2) == pytest.approx((0.05, 0.1, 0.15))
    with pytest.raises(ValueError, match="3 numbers"):
        Color((1, 2, 3, 4))
