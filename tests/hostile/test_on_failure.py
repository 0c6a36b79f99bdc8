"""A program may ask for the error of a part that fails."""

from __future__ import annotations

import sys
import traceback
from pathlib import Path
from typing import Any

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import faulty_parts as parts
import test_faults_stay as stay
from faults import FAULTS

import morse

reset = stay.reset


@pytest.mark.parametrize("kind", [kind for kind in stay.KINDS if kind not in ("no data", "action", "tap")])
@pytest.mark.parametrize("error", ["ValueError", "Strange", "Closed"])
def test_the_error_is_raised_after_the_tick(kind: str, error: str, caplog: pytest.LogCaptureFixture) -> None:
    parts.fault = FAULTS[error]
    who, _ = stay.KINDS[kind]
    with stay.Run(kind, 4, on_failure="raise") as run:
        with pytest.raises(BaseException) as caught:  # noqa: PT011 (errors of any class)
            run.go()
        assert type(caught.value).__name__ == error
        assert any(frame.filename.endswith("faults.py") for frame in traceback.extract_tb(caught.value.__traceback__))
        if error != "Closed":
            (note,) = caught.value.__notes__
            assert who in note or who.split()[-1] in note
            assert f"tick {run.simulation.ticks}" in note
        parts.fault = list
        before = run.simulation.ticks
        run.simulation.step(2)
        assert run.simulation.ticks == before + 2
    others = [one for one in caplog.messages if " failed and " in one]
    assert all("is left as it is" in one for one in others), "only what failed later is logged"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("rise", "did you mean 'raise'?"),
        ("Deactivate", "did you mean 'deactivate'?"),
        (None, "not None"),
        ([], "not []"),
    ],
)
def test_unknown_values_are_named(value: Any, text: str) -> None:
    with pytest.raises(ValueError, match="on_failure is 'deactivate' or 'raise'") as caught:
        morse.load(stay._scene(1), on_failure=value)
    assert text in str(caught.value)
