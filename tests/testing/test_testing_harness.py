"""Test files in the style of 1.4, run by a real simulation."""

import os
import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

import pytest

from morse.builder import *  # noqa: F403
from morse.testing.exceptions import MorseTestingError
from morse.testing.testing import MorseMoveTestCase, MorseSwitchTimeMode, main
from pymorse import Morse

pytestmark = pytest.mark.long

SOURCE = Path(__file__).parents[2] / "src"
CASE = '''
from morse.testing.testing import {base}, main
from pymorse import Morse

class {name}({base}):
    def setUpEnv(self):
        """ Defines the test scenario, using the Builder API. """
        {scene}
        env = Environment('empty', fastmode = True)

{tests}

if __name__ == "__main__":
    main({name})
'''
ROBOT = """robot = ATRV()
        robot.translate(x=1.0)
        pose = Pose()
        robot.append(pose)
        pose.add_stream('socket')"""
DRIVING = (
    ROBOT
    + """
        motion = MotionVW()
        robot.append(motion)
        motion.add_stream('socket')
        teleport = Teleport()
        robot.append(teleport)
        teleport.add_stream('socket')"""
)


def write(directory: Path, base: str, scene: str, tests: str) -> Path:
    file = directory / "case.py"
    body = textwrap.indent(textwrap.dedent(tests).strip(), "    ")
    file.write_text(CASE.format(base=base, name="A_Case", scene=scene, tests=body))
    return file


def execute(file: Path, *words: str) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": str(SOURCE)}
    return subprocess.run(
        [sys.executable, *words, str(file)],
        cwd=file.parent,
        env=environment,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )


def test_a_file_of_1_4_runs_in_both_time_modes(tmp_path: Path) -> None:
    file = write(
        tmp_path,
        "MorseTestCase",
        ROBOT,
        """
        def test_time(self):
            with Morse() as simu:
                print("MODE", simu.rpc("time", "mode"))
                self.assertAlmostEqual(simu.robot.pose.get()["x"], 1.0, delta=0.01)
                self.assertEqual(simu.robots, ["robot"])
        """,
    )
    ran = execute(file)
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert [line for line in ran.stdout.splitlines() if line.startswith("MODE")] == [
        "MODE Best Effort",
        "MODE Fixed Simulation Step",
    ]
    assert "Ran 2 tests" in ran.stderr
    assert "EXITING SIMULATION" in (tmp_path / "A_Case.log").read_text()


def test_a_failing_test_is_a_failure(tmp_path: Path) -> None:
    file = write(tmp_path, "MorseTestCase", ROBOT, "def test_it(self):\n    self.assertEqual(1, 2)")
    file.write_text(file.read_text().replace("main(A_Case)", "main(A_Case, time_modes=[0])"))
    ran = execute(file)
    assert ran.returncode == 1
    assert "1 != 2" in ran.stderr
    assert "Ran 1 test" in ran.stderr


def test_robots_that_move_are_put_back_in_place(tmp_path: Path) -> None:
    file = write(
        tmp_path,
        "MorseMoveTestCase",
        DRIVING,
        """
        def test_it(self):
            with Morse() as simu:
                simu.deactivate("robot.teleport")
                self.assertAlmostEqualPositionThenFix(simu, [1.0, 0.0, 0.10, 0.0, 0.0, 0.0], 0.05)
                # exactly two seconds, however busy the machine is
                simu.pause()
                simu.robot.motion.publish({"v": 1.0, "w": 0.0})
                simu.step(120)
                simu.robot.motion.publish({"v": 0.0, "w": 0.0})
                simu.step(12)
                simu.resume()
                self.assertAlmostEqualPositionThenFix(simu, [3.0, 0.0, 0.10, 0.0, 0.0, 0.0], 0.15)
                simu.sleep(0.5)
                self.assertAlmostEqualPosition(simu, [3.0, 0.0, 0.10, 0.0, 0.0, 0.0], 0.02)
                with self.assertRaisesRegex(AssertionError, "x is 3"):
                    self.assertAlmostEqualPosition(simu, [2.0, 0.0, 0.10, 0.0, 0.0, 0.0], 0.02)
        """,
    )
    file.write_text(file.read_text().replace("main(A_Case)", "main(A_Case, time_modes=['FixedSimulationStep'])"))
    ran = execute(file)
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_a_scene_that_is_refused(tmp_path: Path) -> None:
    file = write(
        tmp_path,
        "MorseBuilderFailureTestCase",
        "robot = NoSuchRobot()",
        "def test_it(self):\n    self.assertIn('NoSuchRobot', self.refusal)",
    )
    file.write_text(file.read_text().replace("main(A_Case)", "main(A_Case, time_modes=[1])"))
    ran = execute(file)
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_a_scene_that_cannot_be_built_is_an_error_that_says_why(tmp_path: Path) -> None:
    file = write(tmp_path, "MorseTestCase", "robot = NoSuchRobot()", "def test_it(self):\n    pass")
    file.write_text(file.read_text().replace("main(A_Case)", "main(A_Case, time_modes=[1])"))
    ran = execute(file)
    assert ran.returncode == 1
    assert "MorseTestingError: the simulation did not start: [ERROR][MORSE]" in ran.stderr
    assert "NoSuchRobot" in ran.stderr


def test_an_error_of_the_simulation_ends_a_test_that_waits(tmp_path: Path, fake_morse: Callable[[str], None]) -> None:
    fake_morse(
        """
server = socket.create_server(("127.0.0.1", 0))
print("services are on port", server.getsockname()[1], flush=True)
print("[SCENE INITIALIZED]", flush=True)
time.sleep(0.5)
print("[ERROR][MORSE] it broke", flush=True)
server.accept()
print("[EXITING SIMULATION]")
"""
    )
    file = write(
        tmp_path,
        "MorseTestCase",
        ROBOT,
        """
        def test_it(self):
            import time
            time.sleep(60)

        def test_next(self):
            pass
        """,
    )
    file.write_text(file.read_text().replace("main(A_Case)", "main(A_Case, time_modes=[1])"))
    ran = execute(file)
    assert ran.returncode == 1
    assert ran.stderr.count("MorseTestingError: the simulation reported an error: [ERROR][MORSE] it broke") >= 1
    assert "Ran 2 tests" in ran.stderr


def test_a_test_file_can_be_run_as_a_scene(tmp_path: Path) -> None:
    file = write(tmp_path, "MorseTestCase", ROBOT, "def test_it(self):\n    pass")
    file.write_text("from morse.builder import *\n" + file.read_text())
    program = "from morse.cli import main; main()"
    environment = {**os.environ, "PYTHONPATH": str(SOURCE), "MORSE_SOCKET_PORT": "0"}
    ran = subprocess.run(
        [sys.executable, "-c", program, "run", "--headless", "--speed", "max", "--duration", "0.1", str(file)],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    assert "ROBOT: 'robot'" in ran.stdout


def test_a_case_without_a_scene_says_so() -> None:
    with pytest.raises(NotImplementedError, match="define setUpEnv"):
        MorseMoveTestCase().setUpEnv()


@pytest.mark.parametrize("mode", [2, "Fast", None, 1.5])
def test_an_unknown_time_mode_is_refused(mode: object) -> None:
    with pytest.raises(ValueError, match="is not a time mode: expected one of BestEffort, FixedSimulationStep"):
        MorseSwitchTimeMode([], mode)


def test_main_needs_a_case() -> None:
    with pytest.raises(TypeError, match="at least one test case"):
        main()


def scene_of_the_fixture() -> None:
    robot = ATRV()  # noqa: F405
    pose = Pose()  # noqa: F405
    robot.append(pose)
    robot.add_default_interface("socket")
    env = Environment("empty", fastmode=True)  # noqa: F405, F841


def test_the_fixture_runs_a_function_and_a_file(simulate: Callable[..., Morse], tmp_path: Path) -> None:
    script = tmp_path / "two.py"
    script.write_text(
        "from morse.builder import *\nfor i in range(2):\n    m = FakeRobot()\n    AbstractComponent.close_context(2)\n"
        "env = Environment('empty', fastmode=True)\n"
    )
    first = simulate(scene_of_the_fixture)
    second = simulate(script, "--seed", "5")
    assert first.port != second.port
    assert first.robots == ["robot"]
    assert first.robot.pose.get(60)["z"] == pytest.approx(0.10, abs=0.01)
    assert len(second.robots) == 2
    assert second.rpc("simulation", "get_seed") == 5


def test_the_fixture_refuses_a_scene_that_cannot_be_built(simulate: Callable[..., Morse], tmp_path: Path) -> None:
    script = tmp_path / "wrong.py"
    script.write_text("from morse.builder import *\nrobot = Morsi()\n")
    with pytest.raises(MorseTestingError, match="Morsi"):
        simulate(script)
