"""Blocks of data fields come back exactly, and damaged ones are refused."""

import contextlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from morse.recording.errors import RecordingError
from morse.recording.fields.blocks import ReadBlock, encode_block
from morse.recording.fields.columns import Keeper
from tests.kit.effort import examples

_plain = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(),
    st.floats(allow_nan=False),
    st.text(st.characters(codec="utf-8")),
    st.binary(),
)
_values = st.recursive(
    _plain,
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.tuples(inner, inner),
        st.dictionaries(st.text(st.characters(codec="utf-8"), max_size=4), inner, max_size=3),
    ),
    max_leaves=8,
)
_arrays = [
    np.arange(6).astype(dtype).reshape(shape)
    for dtype in ("uint8", "int16", "float32", "float64", "bool")
    for shape in ((6,), (2, 3), (1, 2, 3))
]


def _read(columns: dict[str, list[Any]]) -> list[dict[str, Any]]:
    keeper, count = Keeper(), len(next(iter(columns.values())))
    kept = {name: tuple(keeper.kept(value) for value in values) for name, values in columns.items()}
    ticks = np.arange(count)
    block = ReadBlock(encode_block(ticks, ticks * 10, kept), "the file")
    assert len(block) == count
    return [block.row(row).values for row in range(count)]


def _is_same(one: Any, other: Any) -> bool:
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()
    return type(one) is type(other) and one == other


@given(st.lists(_values, min_size=1, max_size=5))
@settings(max_examples=examples(100), deadline=None)
def test_values_of_all_kinds_come_back(values: list[Any]) -> None:
    rows = _read({"it": values})
    assert all(_is_same(row["it"], value) for row, value in zip(rows, values, strict=True))


@given(st.lists(st.sampled_from(_arrays), min_size=1, max_size=4))
@settings(max_examples=examples(40), deadline=None)
def test_arrays_of_equal_and_of_different_shapes_come_back(arrays: list[Any]) -> None:
    rows = _read({"it": arrays})
    assert all(_is_same(row["it"], array) for row, array in zip(rows, arrays, strict=True))


def test_bits_of_numbers_are_those_of_the_tick() -> None:
    odd = [0.0, -0.0, float("nan"), float("inf"), 5e-324, 1.7976931348623157e308]
    (row,) = _read({"it": [odd]})
    assert np.array(row["it"]).tobytes() == np.array(odd).tobytes()


def test_an_array_that_changes_afterwards_was_copied() -> None:
    array = np.zeros(3)
    kept = Keeper().kept(array)
    array[:] = 1.0
    assert kept.tolist() == [0.0, 0.0, 0.0]


@given(st.integers(0, 400), st.integers(0, 255))
@settings(max_examples=examples(200), deadline=None)
def test_damaged_blocks_are_refused_or_read(place: int, byte: int) -> None:
    keeper = Keeper()
    columns = {"a": np.arange(3.0), "b": (keeper.kept("x"),) * 3, "c": tuple(map(keeper.kept, [{}, [1], None]))}
    data = bytearray(encode_block([1, 2, 3], np.arange(3), columns))
    data[place % len(data)] = byte
    with contextlib.suppress(RecordingError):
        block = ReadBlock(bytes(data), "the file")
        for row in range(len(block)):
            block.row(row)


def test_a_block_that_claims_more_rows_than_it_has_is_refused() -> None:
    data = encode_block([1, 2, 3], np.arange(3), {"a": np.arange(2.0)})
    with pytest.raises(RecordingError, match="another length"):
        ReadBlock(data, "the file")
