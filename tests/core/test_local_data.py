"""Fields that are computed when they are read look to every reader as if they had always been there."""

import copy
import json
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from morse.core.realism import copied
from morse.core.streams.local_data import Later, LocalData
from morse.wire.encoding import to_json

PLAIN: dict[str, Any] = {"timestamp": 1.5, "point_list": [[1.0, 2.0, 3.0]], "range_list": [4.0, 5.0]}


def lazy() -> LocalData:
    data = LocalData(PLAIN)
    data["point_list"] = Later(lambda: np.array([[1.0, 2.0, 3.0]]))
    data["range_list"] = Later(lambda: np.array([4.0, 5.0]))
    return data


def listed(array: Any) -> Any:
    return array.tolist()


def plain(data: dict[str, Any]) -> dict[str, Any]:
    return {key: listed(value) if isinstance(value, np.ndarray) else value for key, value in data.items()}


WAYS: dict[str, Callable[[Any], Any]] = {
    "dict": dict,
    "stars": lambda data: dict(**data),
    "display": lambda data: {**data},
    "update": lambda data: _updated(data),
    "or": lambda data: {} | data,
    "or, first": lambda data: data | {},
    "items": lambda data: dict(data.items()),
    "values": lambda data: dict(zip(data, data.values(), strict=True)),
    "keys": lambda data: {key: data[key] for key in data},
    "get": lambda data: {key: data.get(key) for key in list(data)},
    "setdefault": lambda data: {key: data.setdefault(key, 0) for key in PLAIN},
    "pop": lambda data: {key: data.pop(key) for key in PLAIN},
    "popitem": lambda data: dict([data.popitem() for _ in PLAIN][::-1]),
    "copy": lambda data: data.copy(),
    "copy.copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda data: pickle.loads(pickle.dumps(data.copy())),
    "copied": copied,
    "json": lambda data: json.loads(json.dumps(data, default=listed)),
    "indented json": lambda data: json.loads(json.dumps(data, indent=1, default=listed)),
    "socket": lambda data: json.loads(to_json(data)),
    "repr": lambda data: eval(repr(data), {"array": np.array}),
}


def _updated(data: LocalData) -> dict[str, Any]:
    result: dict[str, Any] = {}
    result.update(data)
    return result


@pytest.mark.parametrize("way", WAYS)
def test_every_way_of_reading_finds_the_values_in_their_order(way: str) -> None:
    found = WAYS[way](lazy())
    assert list(found) == list(PLAIN)
    assert plain({key: found[key] for key in PLAIN}) == PLAIN
    assert all(type(value) is not Later for value in dict.values(found))


def test_the_messages_are_the_same_byte_for_byte() -> None:
    assert to_json(lazy()) == to_json(PLAIN) == json.dumps(PLAIN).encode()


def test_a_value_is_worked_out_once_and_only_if_it_is_read() -> None:
    calls: list[str] = []
    data = LocalData(timestamp=0.0)
    data["seen"] = Later(lambda: calls.append("seen") or [1.0])
    data["unseen"] = Later(lambda: calls.append("unseen") or [2.0])
    assert "seen" in data
    assert len(data) == 3
    assert calls == []
    data["seen"].append(9.0)  # like a modifier
    assert data["seen"] == [1.0, 9.0]
    assert calls == ["seen"]


def test_what_is_missing_is_missing() -> None:
    with pytest.raises(KeyError):
        lazy()["speed"]
    with pytest.raises(KeyError):
        lazy().pop("speed")
    assert lazy().pop("speed", 3) == 3
    assert lazy().get("speed") is None
    with pytest.raises(TypeError):
        hash(lazy())
