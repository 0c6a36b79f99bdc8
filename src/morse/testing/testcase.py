"""Test cases that run in a simulation."""

from __future__ import annotations

import _thread
import logging
import math
import os
import signal
import sys
import tempfile
import threading
import unittest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from morse.testing.exceptions import MorseTestingError
from morse.testing.follow import unexpected
from morse.testing.process import PORT_VARIABLE, SimulationProcess, preferred_port
from morse.testing.scripts import script_of_method
from pymorse.pymorse import PORTS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from pymorse import Morse


testlogger = logging.getLogger("morsetesting.general")

BEST_EFFORT = "BestEffort"
FIXED_STEP = "FixedSimulationStep"


class MorseTestCase(unittest.TestCase):
    """Runs the scene that `setUpEnv` describes during each test.

    The log of the simulation is written to ``<name of the class>.log`` in the working directory. If the log reports an
    error, the test fails immediately. Services are on port 4000 if that port is free; ``Morse()`` finds their port in
    any case.

    Attributes:
        time_mode: ``BestEffort`` or ``FixedSimulationStep``, see `main`.
        physics_of_1_4: whether driven robots are as slow as in MORSE 1.4 (`env.use_physics_of_1_4`), because the tests
            of 1.4 were adjusted to its engine.
        fails: names of the parts that the tests expect to fail, such as ``robot.gps``: each test fails unless they do.
        simulation: the running process.
    """

    time_mode = BEST_EFFORT
    fails: Sequence[str] = ()
    physics_of_1_4 = True
    simulation: SimulationProcess | None = None

    def setUpMw(self) -> None:  # noqa: N802
        """Start other programs of the test, such as a middleware; called before the simulation starts."""

    def tearDownMw(self) -> None:  # noqa: N802
        """Stop the programs that `setUpMw` started; called after the simulation has ended."""

    def setUpEnv(self) -> None:  # noqa: N802
        """Build the scene.

        The source of this method is run by the simulation, in another process. It may use the names of
        ``morse.builder`` without importing them, but no names of its own module. It has to assign the environment to a
        variable ``env``.
        """
        raise NotImplementedError(f"{type(self).__name__} has no scene: define setUpEnv(self)")

    def setUp(self) -> None:
        """Start the simulation."""
        self.addCleanup(self.tearDownMw)
        self.setUpMw()
        self._interruption = threading.Lock()
        self._interruptible = self._reported = False
        self._previous_port = os.environ.get(PORT_VARIABLE)
        self.addCleanup(self._restore_port)
        self.launch_simulator()

    def tearDown(self) -> None:
        """End the simulation."""
        simulation, self.simulation = self.simulation, None
        if simulation is not None:
            simulation.stop()
            wrong = unexpected(simulation.watch.errors, self.fails)
            if wrong and not self._reported:
                raise MorseTestingError("\n".join(wrong))

    def launch_simulator(self) -> None:
        """Write the scene script, start the simulation and wait until it runs."""
        if type(self).setUpEnv is MorseTestCase.setUpEnv:
            MorseTestCase.setUpEnv(self)
        scene = script_of_method(self.setUpEnv, self.time_mode, physics_of_1_4=self.physics_of_1_4)
        directory = tempfile.TemporaryDirectory(prefix="morse_")
        self.addCleanup(directory.cleanup)
        script = Path(directory.name) / "scene"
        script.write_text(scene, encoding="utf-8")
        testlogger.info("%s: starting a simulation (%s)", self.id(), self.time_mode)
        port = int(self._previous_port) if self._previous_port else preferred_port(PORTS[0])
        log = Path(f"{type(self).__name__}.log")
        self.simulation = SimulationProcess(script, log, port=port, on_error=self._on_error, fails=self.fails)
        try:
            self.wait_initialization()
        except BaseException:
            self.simulation.kill()
            raise

    def wait_initialization(self) -> None:
        """Wait until the simulation runs; clients find it from then on."""
        assert self.simulation is not None
        self.simulation.wait_initialized()
        os.environ[PORT_VARIABLE] = str(self.simulation.port)

    def _restore_port(self) -> None:
        if self._previous_port is None:
            os.environ.pop(PORT_VARIABLE, None)
        else:
            os.environ[PORT_VARIABLE] = self._previous_port

    def _on_error(self, line: str) -> None:
        testlogger.error("%s: %s", self.id(), line)
        with self._interruption:
            if self._interruptible:
                # the test may be waiting for an answer that will not arrive
                _interrupt_main_thread()

    def _callTestMethod(self, method: Callable[[], object]) -> None:  # noqa: N802 (of unittest)
        self._interruptible = True
        try:
            try:
                method()
            finally:
                # waits until a pending interrupt was delivered, so that it does not affect later code
                with self._interruption:
                    self._interruptible = False
        except KeyboardInterrupt:
            if self.simulation is None or self.simulation.watch.error is None:
                raise
            self._reported = True
            raise MorseTestingError(f"the simulation reported an error: {self.simulation.watch.error}") from None


def _interrupt_main_thread() -> None:
    if hasattr(signal, "pthread_kill"):
        # unlike interrupt_main, this also ends a sleep
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)
    else:
        _thread.interrupt_main()


class MorseMoveTestCase(MorseTestCase):
    """Tests of a moving robot.

    The scene has a robot with the name ``robot``, whose components are ``pose``, ``motion`` and ``teleport``.
    """

    def assertAlmostEqualPosition(  # noqa: N802
        self, simu: Morse, expected_pose: Sequence[float], precision: float
    ) -> None:
        """Check the pose of ``simu.robot``.

        Args:
            simu: connection to the simulation.
            expected_pose: x, y, z (m), yaw, pitch, roll (rad).
            precision: the largest difference, m and rad.
        """
        pose = simu.robot.pose.get()
        for name, value in zip(("x", "y", "z", "yaw", "pitch", "roll"), expected_pose, strict=True):
            difference = pose[name] - value
            if name in ("yaw", "pitch", "roll"):
                difference = math.remainder(difference, 2.0 * math.pi)
            if not abs(difference) <= precision:
                self.fail(f"{name} is {pose[name]:g}, expected {value:g} within {precision:g}; the pose is {pose}")

    def assertAlmostEqualPositionThenFix(  # noqa: N802
        self, simu: Morse, expected_pose: Sequence[float], precision: float
    ) -> None:
        """Check the pose of ``simu.robot``, and move it 1 cm above the expected pose, so that errors do not accumulate.

        Args:
            simu: connection to the simulation.
            expected_pose: x, y, z (m), yaw, pitch, roll (rad).
            precision: the largest difference, m and rad.
        """
        self.assertAlmostEqualPosition(simu, expected_pose, precision)
        simu.deactivate("robot.motion")
        x, y, z, yaw, pitch, roll = expected_pose
        simu.robot.teleport.publish({"x": x, "y": y, "z": z + 0.01, "yaw": yaw, "pitch": pitch, "roll": roll})
        simu.activate("robot.teleport")
        simu.sleep(0.1)
        simu.deactivate("robot.teleport")
        simu.activate("robot.motion")
        simu.sleep(0.1)


class MorseBuilderFailureTestCase(MorseTestCase):
    """Tests that a scene is refused: `setUpEnv` has to make the simulation report an error.

    Attributes:
        refusal: the line of the log with the reason.
    """

    refusal = ""

    def wait_initialization(self) -> None:
        """Wait until the simulation reports an error."""
        assert self.simulation is not None
        self.refusal = self.simulation.wait_refused()

    def tearDown(self) -> None:
        """Do nothing, because the simulation has ended."""
        self.simulation = None


# Runs test cases from the command line.


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
