"""Messages that are encoded together have the bytes of those that are encoded one by one."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.core.kinds.turning import quaternion_of
from morse.mathutils.rotation_rows import quaternions_from_rotations, quaternions_of
from morse.mathutils.rotations import quaternion_from_rotation, rotation_from_euler
from morse.rosmsgs.cdr import encode, encode_rows
from morse.rosmsgs.definitions import PRIMITIVES, SEQUENCE, SINGLE, MessageField, fields_of, messages
from morse.rosmsgs.parts import quaternion
from tests.kit.effort import examples

_COUNT = 3
_angles = st.floats(-7.0, 7.0, width=32)


def _numbers(draw: Any, kind: str, shape: tuple[int, ...]) -> Any:
    letter = PRIMITIVES[kind]
    if letter in "fd":
        return np.array(draw(st.lists(st.floats(width=32), min_size=(n := int(np.prod(shape))), max_size=n))).reshape(
            shape
        )
    return np.array(draw(st.lists(st.integers(0, 1), min_size=(n := int(np.prod(shape))), max_size=n))).reshape(shape)


def _drawn(draw: Any, field: MessageField) -> tuple[Any, list[Any]]:
    """A value for all messages, and the values of each."""
    if field.type in PRIMITIVES:
        size = draw(st.integers(0, 4)) if field.size == SEQUENCE else max(field.size, 1)
        rows = _numbers(draw, field.type, (_COUNT,) if field.size == SINGLE else (_COUNT, size))
        each = [row.item() if field.size == SINGLE else row for row in rows]
        return (rows, each) if draw(st.booleans()) else (each[0], [each[0]] * _COUNT)
    if field.type == "string":
        text: Any = draw(st.text(max_size=5))
        if field.size != SINGLE:
            text = [text] * (2 if field.size == SEQUENCE else field.size)
        return text, [text] * _COUNT
    if field.size == SINGLE:
        return _message(draw, field.type)
    pairs = [
        _message(draw, field.type) for _ in range(draw(st.integers(0, 2)) if field.size == SEQUENCE else field.size)
    ]
    return [rows for rows, _ in pairs], [[each[k] for _, each in pairs] for k in range(_COUNT)]


def _message(draw: Any, name: str) -> tuple[dict[str, Any], list[dict[str, Any]]]:
    parts = {field.name: _drawn(draw, field) for field in fields_of(name)}
    return {key: rows for key, (rows, _) in parts.items()}, [
        {key: each[k] for key, (_, each) in parts.items()} for k in range(_COUNT)
    ]


@given(st.data())
@settings(max_examples=examples(300), deadline=None)
def test_every_type_of_message_has_the_same_bytes(data: Any) -> None:
    name = data.draw(st.sampled_from(sorted(messages())))
    rows, each = data.draw(st.composite(lambda draw: _message(draw, name))())
    encoded = encode_rows(name, rows, _COUNT)
    assert [row.tobytes() for row in encoded] == [encode(name, one) for one in each]


@pytest.mark.parametrize(("name", "value"), [("Bool", 2), ("Int64", 2.5)])
def test_numbers_that_do_not_fit_are_refused(name: str, value: float) -> None:
    with pytest.raises((OverflowError, ValueError)):
        encode_rows(f"std_msgs/msg/{name}", {"data": np.array([value, value])}, 2)


@given(st.lists(st.tuples(_angles, _angles, _angles), min_size=1, max_size=20))
@settings(max_examples=examples(200), deadline=None)
def test_rotations_have_the_same_bits_together_and_alone(angles: list[tuple[float, float, float]]) -> None:
    columns = np.array(angles, dtype=np.float64).T
    together = np.stack(quaternions_of(*columns), axis=-1)
    assert together.tobytes() == np.array([quaternion_of(*one) for one in angles], dtype=np.float64).tobytes()
    matrices = [rotation_from_euler(one, "XYZ") for one in angles]
    together = np.stack(quaternions_from_rotations(np.array(matrices, dtype=np.float64).T), axis=-1)
    assert together.tobytes() == np.array([quaternion_from_rotation(one) for one in matrices]).tobytes()
    named = quaternion(together)
    for row, one in enumerate(together.tolist()):
        assert {axis: float(column[row]) for axis, column in named.items()} == quaternion(one)  # type: ignore[index]
