"""Tests of simulations whose parts fail: they fail unless they say that they expect it, and their runs are recorded."""

import textwrap
from pathlib import Path
from typing import Any

import pytest

from morse.recording.recording import Recording
from morse.testing.follow import unexpected
from morse.testing.scripts import is_text

pytest_plugins = ["pytester"]

PARTS = """
    from morse.core.sensor import Sensor
    from morse.helpers.components import add_data

    class Frail(Sensor):
        add_data("count", 0, "int", "Number of measurements")
        end = False

        def default_action(self):
            self.local_data["count"] += 1
            if self.local_data["count"] > 3 and not self.end:
                raise ValueError("too frail")

        def finalize(self):
            super().finalize()
            if self.end:
                raise OSError("no end")

    class Untidy(Frail):
        end = True
"""
#: the text of an inner test, whether it passes, and what is said about it otherwise
CASES: dict[str, tuple[str, bool, str]] = {
    "a fault": ("simulate(frail, sockets=False, on_failure='raise').step(10)", False, "ValueError: too frail"),
    "that is caught": (
        "simu = simulate(frail, sockets=False)\nwith pytest.raises(ValueError):\n    simu.step(10)", True, "",
    ),
    "that is expected": ("simulate(frail, sockets=False, fails='robot.frail').step(10)", True, ""),
    "that does not come": (
        "simulate(frail, sockets=False, fails=['robot.frail']).step(2)", False,
        "'robot.frail' was expected to fail, and has not failed",
    ),
    "another part": (
        "simulate(frail, sockets=False, fails=['robot.frai']).step(10)", False, "robot.frail failed and is deactivated",
    ),
    "at the end": ("simulate(untidy, sockets=False).step()", False, "OSError: no end"),
    "expected at the end": ("simulate(untidy, sockets=False, fails=['robot.frail']).step()", True, ""),
    "not of interest": ("simulate(frail, sockets=False, on_failure='deactivate').step(10)", True, ""),
    "a fall": ("simulate(falling, sockets=False).step(150)", False, "off has left the world: it is at z = -"),
    "a fall that is expected": ("simulate(falling, sockets=False, fails=['off']).step(150)", True, ""),
    "beside": ("step(simulate(frail), 10)", False, "robot.frail failed and is deactivated: ValueError: too frail"),
    "beside, at the end": ("step(simulate(untidy), 1)", False, "robot.frail failed and ended: OSError: no end"),
    "beside and expected": ("step(simulate(frail, fails=['robot.frail']), 10)", True, ""),
    "beside and expected at the end": ("step(simulate(untidy, fails=['robot.frail']), 1)", True, ""),
    "beside, not of interest": ("step(simulate(frail, on_failure='deactivate'), 10)", True, ""),
    "a fall beside": ("step(simulate(falling), 150)", False, "off has left the world: it is at z = -"),
    "a fall beside that is expected": ("step(simulate(falling, fails='off'), 150)", True, ""),
}  # fmt: skip
HEAD = """
    import pytest
    from morse.builder import *
    from parts import Frail, Untidy

    def frail(cls=Frail):
        robot = FakeRobot("robot")
        robot.append(cls("frail"))
        robot.add_default_interface("socket")
        env = Environment("empty", fastmode=True)

    def untidy():
        frail(Untidy)

    def falling():
        frail(Pose)
        off = ATRV("off")
        off.translate(21, 0, 0.1)

    def step(simu, ticks):
        simu.rpc("simulation", "pause")
        simu.rpc("simulation", "step", ticks)
"""


def _run(pytester: pytest.Pytester, text: str, *plugins: str) -> Any:
    pytester.makeconftest(f"pytest_plugins = {list(plugins or ('morse.testing.fixtures',))!r}")
    Path("parts.py").write_text(textwrap.dedent(PARTS), encoding="utf-8")
    Path("test_inner.py").write_text(textwrap.dedent(HEAD) + textwrap.dedent(text), encoding="utf-8")
    return pytester.runpytest_subprocess("-p", "no:cacheprovider", "-p", "no:randomly", "-rA")


@pytest.mark.parametrize("beside", [False, True])
def test_a_test_fails_unless_it_expects_the_fault(pytester: pytest.Pytester, beside: bool) -> None:
    cases = {name: case for name, case in CASES.items() if ("beside" in name) == beside}
    names = [f"test_{number}" for number in range(len(cases))]
    text = "".join(
        f"\ndef {name}(simulate):\n{textwrap.indent(body, '    ')}\n"
        for name, (body, _, _) in zip(names, cases.values(), strict=True)
    )
    outcome = _run(pytester, text)
    output = outcome.stdout.str()
    for name, (case, (_, passes, said)) in zip(names, cases.items(), strict=True):
        has_failed = f"FAILED test_inner.py::{name} " in output or f"ERROR test_inner.py::{name} " in output
        assert has_failed != passes, f"{case}\n{output}"
        assert said in output
        recordings = list(Path("failed_simulations", name).glob("*.mcap"))
        assert [path.name for path in recordings] == ([] if passes else ["scene0.mcap"]), f"{case}\n{output}"


FAILING = """
    def drive():
        robot = ATRV("robot")
        robot.append(MotionVW("motion"))
        robot.append(Pose("pose"))
        robot.add_default_interface("socket")
        Environment("empty", fastmode=True)

    @pytest.mark.parametrize("sockets", [False, True])
    def test_it_flies(simulate, sockets):
        simu = simulate(drive, seed=4, sockets=sockets)
        simu.rpc("simulation", "pause")
        simu.rpc("simulation", "reset")
        simu.robot.motion.publish({"v": 1.0})
        simu.rpc("simulation", "step", 60)
        assert False, "not yet"

    def test_it_cheats(simulate):
        simu = simulate("robot = ATRV()", sockets=False)
        simu.context.robots["robot"].bge_object.worldPosition = (3.0, 0.0, 0.1)
        simu.step(3)
        assert False

    @pytest.mark.xfail
    def test_xfail(simulate):
        simulate(drive, sockets=False)
        assert False

    def test_it_passes(simulate):
        simulate(drive, sockets=False).step(3)
"""


def test_a_test_that_fails_keeps_a_recording(pytester: pytest.Pytester) -> None:
    for _ in range(2):  # the second run replaces the recordings
        outcome = _run(pytester, FAILING)
    outcome.assert_outcomes(passed=1, failed=3, xfailed=1)
    output = outcome.stdout.str()
    folders = sorted(path.name for path in Path("failed_simulations").iterdir())
    assert folders == ["test_it_cheats", "test_it_flies_False_", "test_it_flies_True_"]
    for folder in folders[1:]:
        path = Path("failed_simulations", folder, "scene0.mcap").resolve()
        assert f"recording: {path}\n" in output
        with Recording(path) as recording:
            assert recording.number("seed") == 4
            poses = recording.messages(recording.topic_numbers("/robot/pose"))
            assert sum(1 for _ in poses) >= 60
    assert "scene0.mcap: its end differs, because the test did more than to send commands" in output


MARK = """
    def frail_at_odd_seeds():
        frail()

    @pytest.mark.simulations(frail, seeds=3)
    def test_fault(simulation):
        simulation.step(10)

    @pytest.mark.simulations(frail, seeds=3, fails="robot.frail")
    def test_expected(simulation):
        simulation.step(10)

    @pytest.mark.simulations(frail, seeds=3, fails="robot.frail")
    def test_missing(simulation):
        simulation.step(1)

    @pytest.mark.simulations(untidy, seeds=2)
    def test_end(simulation):
        simulation.step(1)

    @pytest.mark.simulations(falling, seeds=2)
    def test_fall(simulation):
        simulation.step(150)

    @pytest.mark.simulations(falling, seeds=2, fails=["off"])
    def test_expected_fall(simulation):
        simulation.step(150)
"""


def test_the_mark_expects_faults_too(pytester: pytest.Pytester) -> None:
    for _ in range(2):  # the recordings of the first run are replaced
        outcome = _run(pytester, MARK, "morse.testing.simulations")
    outcome.assert_outcomes(passed=2, failed=4)
    output = outcome.stdout.str()
    for said in ("ValueError: too frail", "'robot.frail' was expected to fail", "OSError: no end", "off has left the"):
        assert f"seed 1: {said}" in output or said in output
    assert Path("failed_simulations/test_end/seed1.mcap").stat().st_size > 0


CASE = """
    from morse.testing.testing import MorseTestCase
    import sys

    class Faulty(MorseTestCase):
        fails = {fails}

        def setUpEnv(self):
            import sys
            sys.path.insert(0, {folder!r})
            from parts import Frail
            robot = FakeRobot()
            frail = Frail()
            robot.append(frail)
            env = Environment("empty", fastmode=True)

        def test_it(self):
            import time
            end = time.monotonic() + {limit}
            while time.monotonic() < end and self.simulation.watch.errors == []:
                time.sleep(0.01)
"""


@pytest.mark.parametrize(("fails", "passes"), [("()", False), ("['robot.frail']", True), ("['robot']", False)])
def test_cases_of_unittest(pytester: pytest.Pytester, fails: str, passes: bool) -> None:
    text = CASE.format(fails=fails, folder=str(pytester.path), limit=60)
    outcome = _run(pytester, text.replace("    from morse.testing.testing", "\n    from morse.testing.testing"))
    output = outcome.stdout.str()
    assert (" 1 passed" in output and "failed" not in output.splitlines()[-1]) == passes, output
    assert passes or "robot.frail failed and is deactivated" in output


@pytest.mark.parametrize(
    ("scene", "text"),
    [
        ("robot = ATRV()", True),
        ("robot=ATRV(); pose=Pose(); robot.append(pose)", True),
        ("ATRV('robot')", True),
        ("  robot = ATRV()  ", True),
        ("robot: Robot = ATRV()", True),
        ("from morse.builder import *; robot = ATRV()", True),
        ("for n in range(3): ATRV(f'r{n}')", True),
        ("robot = ATRV()\npose = Pose()", True),
        ("robot = ATRV(", True),
        ("ATRV('r', =)", True),
        ("scene.py", False),
        ("my-scene.py", False),
        ("scenes/default", False),
        ("scene(1).py", False),
        ("v=2.py", False),
        ("kitchen.blend", False),
        ("/tmp/of a test/scene.py", False),
        ("robot", False),
        ("", False),
        ("\x00", False),
        ("(" * 1000, False),
    ],
)
def test_texts_and_paths(scene: str, text: bool) -> None:
    assert is_text(scene) == text


def test_a_file_is_a_path_whatever_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert is_text("run(1)")
    Path("run(1)").touch()
    assert not is_text("run(1)")


@pytest.mark.parametrize("sockets", [True, False])
def test_a_scene_in_one_line(simulate: Any, sockets: bool) -> None:
    simu = simulate("robot = ATRV()", sockets=sockets)
    assert simu.rpc("simulation", "list_robots") == ["robot"]


def test_a_path_that_does_not_exist(simulate: Any, tmp_path: Path) -> None:
    (tmp_path / "warehouse.py").write_text("")
    with pytest.raises(FileNotFoundError, match=r"warehose\.py does not exist; did you mean 'warehouse\.py'\?"):
        simulate(str(tmp_path / "warehose.py"), sockets=False)
    with pytest.raises(Exception, match=r"(?i)did you mean 'warehouse\.py'"):
        simulate(str(tmp_path / "warehose.py"))


def test_names_of_parts_are_whole_names() -> None:
    errors = ["robot.pose failed and is deactivated: x", "the stream Line of robot2.gps failed and is closed"]
    assert unexpected(errors, ["robot.pose", "robot2.gps"]) == []
    for wrong in ("robot.pos", "robot", "obot.pose", "robot2", "gps"):
        assert len(unexpected(errors, ["robot2.gps", wrong])) == 2, "an error and a part that has not failed"
