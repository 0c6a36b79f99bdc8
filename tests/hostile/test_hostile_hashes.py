"""Sets and dictionaries of files whose items have one hash: without a limit, their time is quadratic."""

import itertools
import struct
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from test_hostile_values_in_states import NoReferences

from morse.core.state import Reader, StateError
from morse.recording.errors import RecordingError
from morse.recording.made.reading import Unpacking
from morse.simulation.recordings.input_recording import InputRecording, entry_from_bytes, waiting_from_bytes
from morse.simulation.states.state import State
from morse.system.packed_keys import check_keys
from tests.kit.effort import examples

COUNT = 16
#: the hash of -1 equals that of -2, and that of 2**61 - 1 is 0
TUPLES = [list(values) for values in itertools.product((-1, -2), repeat=COUNT)]
NUMBERS = [["integer", hex((2**61 - 1) * number)] for number in range(8, 50_008)]
PACKED = msgspec.msgpack.encode
SHALLOW = st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text() | st.binary()
DATA = st.recursive(SHALLOW, lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner))


def _map(keys: list[Any]) -> bytes:
    """A map in MessagePack, with keys that an encoder would refuse."""
    return b"\xdf" + struct.pack(">I", len(keys)) + b"".join(PACKED(key) + b"\x01" for key in keys)


def _takes_no_time(read: Callable[[], object], *errors: type[Exception]) -> None:
    begin = time.process_time()
    with pytest.raises(errors):
        read()
    # 65,536 items with one hash need a minute and more
    assert time.process_time() - begin < 10.0


@pytest.mark.parametrize("items", [NUMBERS, [["tuple", values] for values in TUPLES]], ids=["numbers", "tuples"])
@pytest.mark.parametrize("word", ["set", "frozenset", "dict", "counter", "local data", "ordered dict"])
def test_items_with_one_hash_are_refused_at_once(word: str, items: list[Any]) -> None:
    content = items if "set" in word else [[item, 1] for item in items]
    _takes_no_time(lambda: Reader(NoReferences()).part("x", [word, content], None), StateError)


def test_neighbours_on_a_grid_are_restored() -> None:
    cells = [["tuple", [x, y, z]] for x, y, z in itertools.product(range(-12, 12), repeat=3)]
    read = Reader(NoReferences()).part("x", ["set", cells], set())
    assert read == set(itertools.product(range(-12, 12), repeat=3))


@pytest.mark.parametrize(
    "read",
    [
        lambda data: State.from_bytes(b"MORSE state 1\n\x81\xa1x" + data),
        lambda data: entry_from_bytes(b"\x94\x00\xa7service\xa1x" + data),
        waiting_from_bytes,
        lambda data: Unpacking(b"\x81\xa5nodes\x91\x81\xaaproperties\x81\xa1a" + data, lambda _: b"", lambda _: None),
    ],
    ids=["state", "input", "commands", "description"],
)
def test_keys_that_are_arrays_are_refused_before_they_are_decoded(read: Callable[[bytes], object]) -> None:
    _takes_no_time(lambda: read(_map(TUPLES)), StateError, RecordingError)


def test_a_file_of_inputs_with_such_keys_is_refused(tmp_path: Path) -> None:
    (tmp_path / "inputs").write_bytes(b"MORSE inputs 1\n\x92\x94\x00\xc0\x01" + _map(TUPLES) + b"\x90")
    _takes_no_time(lambda: InputRecording.read(tmp_path / "inputs"), StateError)


@given(value=DATA)
@settings(max_examples=examples(200))
def test_what_encoders_write_is_accepted(value: Any) -> None:
    check_keys(PACKED(value))
    with pytest.raises(ValueError, match="a key is not a text"):
        check_keys(PACKED([value, 1])[:-1] + b"\x81\x90" + PACKED(value))


@given(data=st.binary(max_size=64))
@settings(max_examples=examples(300))
def test_any_bytes_are_checked_or_refused(data: bytes) -> None:
    try:
        check_keys(data)
    except (ValueError, LookupError):
        return
    try:
        msgspec.msgpack.decode(data)
    except (ValueError, TypeError, RecursionError):
        return
