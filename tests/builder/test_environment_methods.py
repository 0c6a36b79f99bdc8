"""Methods of the environment that packages bring, and modifiers of all sensors."""

import re
import statistics
from pathlib import Path

import pytest

import morse
from tests.kit.scenes import script

HALF = """
from morse.modifiers.abstract_modifier import AbstractModifier

class Half(AbstractModifier):
    _names = ("Half",)
    _components = ("LaserScanner", "Battery")
    options = {}

    def modify(self):
        for name, value in list(self.data.items()):
            if isinstance(value, float):
                self.data[name] = 0.5 * value
"""


def project(folder: Path, monkeypatch: pytest.MonkeyPatch, method: str, point: str = "my_lab.methods:flood") -> None:
    """A project on the import path whose package has a method of the environment, and a modifier."""
    for path, text in {
        "src/my_lab/__init__.py": "",
        "src/my_lab/methods.py": method,
        "src/my_lab/changes/__init__.py": "",
        "src/my_lab/changes/half.py": HALF,
        "pyproject.toml": f"""
[project]
name = "my_lab"
version = "1.0"
[project.entry-points."morse.environment"]
flood = "{point}"
[project.entry-points."morse.modifiers"]
my_lab = "my_lab.changes"
""",
    }.items():
        (folder / path).parent.mkdir(parents=True, exist_ok=True)
        (folder / path).write_text(text)
    monkeypatch.syspath_prepend(str(folder / "src"))


@pytest.fixture(autouse=True)
def _fresh_modules(monkeypatch: pytest.MonkeyPatch):
    import sys

    yield
    for name in [name for name in sys.modules if name.partition(".")[0] == "my_lab"]:
        del sys.modules[name]


def test_a_package_adds_a_method_and_a_modifier_of_all_sensors(tmp_path: Path, monkeypatch) -> None:
    method = """
def flood(environment, depth=1.0):
    environment.properties(flood=depth)
    environment.alter("Half")
"""
    project(tmp_path, monkeypatch, method)
    scene = """
robot = FakeRobot()
robot.append(Battery("battery"))
robot.append(Pose("pose"))
env = Environment("empty")
env.flood(depth=2.5)
"""
    path = script(tmp_path, scene)
    with morse.load(path) as simulation:
        assert simulation.scene.properties["flood"] == 2.5
        simulation.step(2)
        assert simulation.robot.battery.get()["charge"] < 50.1
        assert not simulation.context.components["robot.pose"].output_modifiers
        simulation.spawn("robot.further", "Battery")
        assert len(simulation.context.components["robot.further"].output_modifiers) == 1
        simulation.restart()
        assert len(simulation.context.components["robot.battery"].output_modifiers) == 1


@pytest.mark.parametrize(
    ("method", "point", "words"),
    [
        ("raise SystemExit(3)", "my_lab.methods:flood", "env.flood of the package my_lab.methods:flood cannot be used"),
        ("flood = 3", "my_lab.methods:flood", "it is 3, expected a function"),
        ("", "my_lab.methods:flood", "cannot be used"),
        ("", "my_lab.nowhere:flood", "No module named"),
        ("def flood(environment):\n    raise KeyError('deep')", "my_lab.methods:flood", "deep"),
        ("def flood(environment):\n    pass", "my_lab.methods:flood", "takes 1 positional argument but 2"),
    ],
)
def test_a_package_that_fails_is_named_with_the_line_of_the_script(
    tmp_path: Path, monkeypatch, method: str, point: str, words: str
) -> None:
    project(tmp_path, monkeypatch, method, point)
    path = script(
        tmp_path,
        'env = Environment("empty")\nenv.flood(1)' if "takes" in words else 'env = Environment("empty")\nenv.flood()',
    )
    with pytest.raises(morse.ScriptError if hasattr(morse, "ScriptError") else Exception, match=re.escape(words)):
        morse.load(path).close()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("env.alter('Nois')", "did you mean 'Noise'"),
        ("env.alter(3)", "modifier_name"),
    ],
)
def test_mistakes_of_a_modifier_for_all_sensors_are_named(tmp_path: Path, call: str, words: str) -> None:
    with pytest.raises(Exception, match=re.escape(words)):
        morse.load(script(tmp_path, f'env = Environment("empty")\n{call}')).close()


def test_each_class_of_a_modifier_for_all_sensors_gets_its_own_options(tmp_path: Path, caplog) -> None:
    """Noise of a pose has other options than that of an IMU: both have what is theirs."""
    text = """
robot = ATRV()
pose, imu = Pose(), IMU()
robot.append(pose)
robot.append(imu)
env = Environment("empty")
env.alter("Noise", pos_std=5.0, gyro_std=0.0, accel_std=0.0)
"""
    with morse.load(script(tmp_path, text)) as sim:
        assert "no option" not in caplog.text
        places, turns = [], []
        for _ in range(20):
            sim.step()
            places.append(sim.robot.pose.get()["x"])
            turns.append(max(map(abs, sim.robot.imu.get()["angular_velocity"])))
    assert statistics.pstdev(places) == pytest.approx(5.0, rel=0.6)
    assert max(turns) < 0.01  # by default, it would be about 0.5
