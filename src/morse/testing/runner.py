"""Runs test cases from the command line."""

from __future__ import annotations

import logging
import sys
import unittest
from typing import TYPE_CHECKING, Any

from morse.testing.testcase import BEST_EFFORT, FIXED_STEP, MorseTestCase, testlogger

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


class MorseSwitchTimeMode(unittest.TestSuite):
    """Tests whose simulations run in one time mode.

    Args:
        tests: cases or suites.
        mode: a member of ``TimeStrategies``, or its name or number.
    """

    def __init__(
        self, tests: Iterable[unittest.TestCase | unittest.TestSuite] = (), mode: object = BEST_EFFORT
    ) -> None:
        super().__init__(tests)
        self.mode = _mode_name(mode)

    def run(self, result: unittest.TestResult, debug: bool = False) -> unittest.TestResult:
        """Run the tests."""
        before, MorseTestCase.time_mode = MorseTestCase.time_mode, self.mode
        testlogger.info("time mode: %s", self.mode)
        try:
            return super().run(result, debug)
        finally:
            MorseTestCase.time_mode = before


def _mode_name(mode: object) -> str:
    names = (BEST_EFFORT, FIXED_STEP)
    name = getattr(mode, "name", mode)
    if isinstance(name, int) and 0 <= name < len(names):
        name = names[name]
    if name not in names:
        raise ValueError(f"{mode!r} is not a time mode: expected one of {', '.join(names)}")
    return str(name)


class MorseTestRunner(unittest.TextTestRunner):
    """Prints the name of every test, and the state of its simulation."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**{"verbosity": 2, **options})

    def setup_logging(self) -> None:
        """Show the messages of `testlogger`."""
        if not testlogger.handlers:
            testlogger.addHandler(logging.StreamHandler())
        testlogger.setLevel(logging.INFO)

    def run(self, test: unittest.TestSuite | unittest.TestCase) -> unittest.TextTestResult:
        """Run a suite."""
        self.setup_logging()
        return super().run(test)


def main(*test_cases: type[MorseTestCase], time_modes: Sequence[object] = (BEST_EFFORT, FIXED_STEP)) -> None:
    """Run test cases, in every time mode, and end the process with status 0 if all pass, otherwise 1.

    A test file can also be given to ``morse run``, which shows the scene of its first case.
    """
    if not test_cases:
        raise TypeError("main() takes at least one test case: main(MyTest)")
    if _inside_simulation():
        test_cases[0]().setUpEnv()
        return
    load = unittest.defaultTestLoader.loadTestsFromTestCase
    suite = unittest.TestSuite(
        MorseSwitchTimeMode([load(test_case) for test_case in test_cases], mode) for mode in time_modes
    )
    sys.exit(0 if MorseTestRunner().run(suite).wasSuccessful() else 1)


def _inside_simulation() -> bool:
    # checked without importing the builder, which tests do not need
    script = sys.modules.get("morse.builder.script")
    return script is not None and bool(script.is_loading())
