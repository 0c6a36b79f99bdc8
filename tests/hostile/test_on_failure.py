"""A program may ask for the error of a part that fails."""

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
from morse.builder import Environment
from morse.core.guard import by_part

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


class Untidy(parts.Gauge):
    """It fails while it ends."""

    def finalize(self) -> None:
        super().finalize()
        parts.fault()


def _untidy() -> None:
    robot = parts.Carriage("r0")
    for number in range(2):
        robot.append(Untidy(f"untidy{number}"))
    Environment("empty", fastmode=True)


def _load(count: int) -> Any:
    return morse.batch(_untidy, count, on_failure="raise") if count > 1 else morse.load(_untidy, on_failure="raise")


@pytest.mark.parametrize("count", [1, 3])
def test_an_error_at_the_end_is_raised_by_close(count: int, caplog: pytest.LogCaptureFixture) -> None:
    """It was neither raised nor logged."""
    simulation = _load(count)
    rows = list(simulation) if count > 1 else [simulation]
    parts.fault = FAULTS["ValueError"]
    with pytest.raises(ValueError, match="a plain error") as caught:
        simulation.close()
    assert "r0.untidy0 failed" in caught.value.__notes__[0]
    assert all(row.finished for row in rows), "all is released"
    for row in rows:
        assert [failure.consequence for failure in row.failures] == ["ended", "ended"]
        assert {failure.part for failure in row.failures} == {"r0.untidy0", "r0.untidy1"}
    simulation.close()
    others = 2 * count - 1
    assert sum(" failed and ended" in one for one in caplog.messages) == others, "nothing is silent"


@pytest.mark.parametrize("count", [1, 2])
def test_an_error_at_the_end_hides_no_other(count: int, caplog: pytest.LogCaptureFixture) -> None:
    with pytest.raises(KeyError, match="of the program"), _load(count):  # noqa: PT012
        parts.fault = FAULTS["ValueError"]
        raise KeyError("of the program")
    assert sum(" failed and ended" in one for one in caplog.messages) == 2 * count


def test_failures_of_rows_and_former_lives() -> None:
    with morse.batch(stay._scene(1), 3) as many:
        many.step(2)
        assert many.failures == [(), (), ()]
        parts.fault, parts.Gauge.where = FAULTS["ValueError"], "sensor"
        many.restart([1])
        many.step(6)
        parts.fault = list
        many.restart()
        (first,), (second,), (third,) = many.failures
        assert first.part == second.part == third.part == "r0.gauge"
        many.step(6)
        assert [len(row) for row in many.failures] == [1, 1, 1]
    assert many.failures == [(first,), (second,), (third,)], "also after the end"


def test_clients_cannot_fill_the_memory_with_failures() -> None:
    with morse.load(stay._scene(1)) as simulation:
        for number in range(2500):
            simulation.context.guard.failed(simulation, f"part {number}", "is closed", ValueError("x"))
        assert len(simulation.failures) == 1000
        text = by_part(simulation.failures)
        assert len(text.splitlines()) == 51
        assert text.endswith("and 950 other parts")
