"""The bits of demos, recipes and topics are those of the file; `python -m tools oracles` writes it."""

import json
from typing import Any

import pytest

from tools import oracles

KEPT: dict[str, Any] = json.loads(oracles.FILE.read_text(encoding="utf-8"))
_HOW = "if a change is meant to have this effect: python -m tools oracles, and say in the commit what changed and why"

#: other processors and versions of MuJoCo and numpy have other bits
only_here = pytest.mark.skipif(oracles.machine() != KEPT["machine"], reason="the file is of another kind of machine")


def test_the_file_has_every_demo_recipe_and_middleware() -> None:
    assert KEPT["states"].keys() == oracles.scenes().keys(), _HOW
    assert KEPT["topics"].keys() == set(oracles.middlewares()), _HOW


@only_here
@pytest.mark.parametrize("name", KEPT["states"])
def test_states(name: str) -> None:
    assert oracles.state_hashes(name) == KEPT["states"][name], _HOW


@only_here
@pytest.mark.parametrize("name", KEPT["topics"])
def test_bytes_of_topics(name: str) -> None:
    assert oracles.topic_hashes(name) == KEPT["topics"][name], _HOW
