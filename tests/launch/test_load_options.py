"""Invalid options of ``morse.load``: refused before anything is loaded."""

import math
from typing import Any

import numpy as np
import pytest

import morse
from morse.builder import ATRV, Environment


def scene() -> None:
    ATRV("robot")
    Environment("empty", fastmode=True)


@pytest.mark.parametrize(
    ("option", "value", "error", "text"),
    [
        ("view", True, ValueError, "'web', 'studio' or None, not True"),
        ("view", "browser", ValueError, "not 'browser'"),
        ("seed", 1.5, TypeError, "seed is an integer"),
        ("seed", "3", TypeError, "seed is an integer"),
        ("seed", True, TypeError, "seed is an integer"),
        ("arguments", "--fast", TypeError, "list of strings"),
        ("arguments", [1], TypeError, "list of strings"),
        ("speed", 0.0, ValueError, "positive"),
        ("speed", -1.0, ValueError, "positive"),
        ("speed", math.nan, ValueError, "positive"),
        ("speed", "max", TypeError, "speed is a number"),
        ("view_port", 70000, ValueError, "0 to 65535"),
        ("view_port", "8765", TypeError, "integer"),
    ],
)
def test_options_that_cannot_be_are_refused(option: str, value: Any, error: type[Exception], text: str) -> None:
    with pytest.raises(error, match=text):
        morse.load(scene, **{option: value})


def test_numbers_of_numpy_are_numbers() -> None:
    with morse.load(scene, seed=np.int64(3), speed=np.float64(2.0)) as sim:
        sim.step(1)
        assert sim.ticks == 1
