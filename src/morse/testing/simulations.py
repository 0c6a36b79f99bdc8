"""The mark ``simulations``: a test that runs with many seeds, and has to pass with most of them."""

from __future__ import annotations

import inspect
from typing import TYPE_CHECKING, Any

import pytest

import morse
from morse.core.reports.faults import place, summary
from morse.testing.exceptions import MorseTestingError
from morse.testing.fixtures import folder_of
from morse.testing.follow import unexpected

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

MARK = "simulations"
_USAGE = '@pytest.mark.simulations("scene.py", seeds=200, at_least=0.95)'
#: number of failed seeds that are recorded, and named in the message
_RECORDED = 20


class Trials:
    """The arguments of the mark of a test.

    Args:
        scene: a scene as for `morse.load`; by default the function ``scene`` of the module of the test.
        seeds: number of seeds, for 0, 1, …; or the seeds.
        at_least: share of the seeds with which the test has to pass.
        fails: names of the parts that are expected to fail, such as ``robot.gps``: it does not pass unless they do.
    """

    def __init__(
        self,
        item: pytest.Function,
        scene: object = None,
        *,
        seeds: Any = 1,
        at_least: float = 1.0,
        fails: str | Sequence[str] = (),
    ) -> None:
        self._item = item
        self.scene: Any = scene if scene is not None else getattr(item.module, "scene", None)
        self.seeds = list(range(seeds)) if isinstance(seeds, int) else list(seeds)
        self.at_least = at_least
        self.fails = [fails] if isinstance(fails, str) else list(fails)
        if self.scene is None:
            raise pytest.UsageError(f"{item.nodeid} has no scene: {_USAGE}, or a function scene() in its module")
        if not self.seeds or not 0.0 <= at_least <= 1.0:
            raise pytest.UsageError(f"{item.nodeid}: at least one seed, and a share from 0 to 1: {_USAGE}")

    def run(self) -> None:
        """Run the test with each seed.

        Raises:
            pytest.fail.Exception: it has passed with fewer seeds; the message names the others and their recordings.
        """
        failures: list[str] = []
        for seed in self.seeds:
            error = self._once(seed)
            if error is None:
                continue
            recording = ""
            if len(failures) < _RECORDED:
                path = folder_of(self._item) / f"seed{seed}.mcap"
                path.unlink(missing_ok=True)
                self._once(seed, path)
                recording = f"; {path}"
            failures.append(f"seed {seed}: {summary(error)}; {place(error).strip()}{recording}")
        passed = len(self.seeds) - len(failures)
        if passed < self.at_least * len(self.seeds):
            more = f"\n... and {len(failures) - _RECORDED} more" if len(failures) > _RECORDED else ""
            pytest.fail(
                f"passed with {passed} of {len(self.seeds)} seeds, at least {self.at_least:.0%} are required\n"
                + "\n".join(failures[:_RECORDED])
                + more,
                pytrace=False,
            )

    def _once(self, seed: int, record: Path | None = None) -> BaseException | None:
        names = inspect.signature(self._item.obj).parameters
        on_failure = "deactivate" if self.fails else "raise"
        simulation = morse.load(self.scene, seed=seed, on_failure=on_failure, record=record)
        try:
            with simulation:
                own: dict[str, Any] = {"simulation": simulation, "seed": seed}
                arguments = {name: own[name] if name in own else self._item.funcargs[name] for name in names}
                self._item.obj(**arguments)
        except (Exception, pytest.fail.Exception) as error:
            return error
        # without expectations, a fault has been raised
        counted = [one for one in simulation.failures if self.fails or one.kind == "fallen"]
        wrong = unexpected([str(one) for one in counted], self.fails)
        return MorseTestingError("; ".join(wrong)) if wrong else None


@pytest.fixture
def simulation() -> Any:
    """The simulation of a test with the mark ``simulations``."""
    return None


@pytest.fixture
def seed() -> int:
    """The seed of a run of a test with the mark ``simulations``."""
    return 0


def pytest_configure(config: pytest.Config) -> None:
    """Register the mark."""
    config.addinivalue_line("markers", f"{MARK}(scene, seeds=1, at_least=1.0, fails=()): runs the test with many seeds")


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool | None:
    """Run a test with the mark once for each seed."""
    mark = pyfuncitem.get_closest_marker(MARK)
    if mark is None:
        return None
    Trials(pyfuncitem, *mark.args, **mark.kwargs).run()
    return True
