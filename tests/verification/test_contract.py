"""The check of the contract: the whole library follows it, and violations are reported with their position."""

import sys
from pathlib import Path

import pytest
from contract_breakers import BREAKERS, BRITTLE_ACTUATOR, SOUND

from morse.cli.app import execute
from morse.verification.contract import SubjectError, check_component
from morse.verification.contract.check import FITS, LOADS, RULES, SAVED
from morse.verification.contract.subjects import library

pytestmark = pytest.mark.long


@pytest.mark.parametrize("name", library())
def test_a_component_of_the_library_keeps_the_contract(name: str) -> None:
    (report,) = check_component(name)
    assert report.passed, str(report)
    assert set(report.checked) == set(RULES)


@pytest.fixture
def sonar(tmp_path: Path) -> Path:
    """The file of a component that follows the contract."""
    file = tmp_path / "sonar.py"
    file.write_text(SOUND)
    return file


def test_a_component_of_ones_own_keeps_it(sonar: Path) -> None:
    (report,) = check_component(sonar)
    assert report.passed, str(report)
    assert report.where.endswith("sonar.py:7")
    assert report.robot == "ATRV"


@pytest.mark.parametrize("case", BREAKERS)
def test_a_broken_rule_is_named_with_its_line(case: str, sonar: Path) -> None:
    rule, text, line = BREAKERS[case]
    sonar.write_text(text)
    (report,) = check_component(sonar)
    assert {fault.rule for fault in report.faults} >= {rule}, str(report)
    number = next((n for n, found in enumerate(text.splitlines(), 1) if line and line in found), None)
    if number is not None:
        assert any(fault.where.endswith(f"sonar.py:{number}") for fault in report.of(rule)), str(report)
    # one error without consequential errors
    assert {fault.rule for fault in report.faults} <= {rule, "saved and restored", "a reset makes it new"}


def test_a_command_that_switches_an_actuator_off(tmp_path: Path) -> None:
    file = tmp_path / "divider.py"
    file.write_text(BRITTLE_ACTUATOR)
    (report,) = check_component(file)
    (fault,) = report.faults
    assert fault.rule == "survives bad commands"
    assert "number=0" in fault.text
    assert "ZeroDivisionError" in fault.text
    assert fault.where.endswith("divider.py:11")


def test_the_command_prints_the_report(sonar: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert execute(["check", "component", str(sonar)]) == 0
    said = capsys.readouterr()
    assert "Sonar, on ATRV" in said.out
    assert all(f"  yes {rule}\n" in said.out for rule in RULES)
    assert said.err == ""
    sonar.write_text(BREAKERS["unit"][1])
    assert execute(["check", "component", str(sonar), "Clock"]) == 1
    said = capsys.readouterr()
    assert "sonar.py:12: the data field 'distance' has no unit" in said.out
    assert "* Sonar: 1 fault." in said.out
    assert "* Clock satisfies the contract." in said.out


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (["component", "Posse"], "did you mean 'Pose'"),
        (["component"], "Which component?"),
        (["componen", "Pose"], "Did you mean 'component'?"),
        (["--robot", "ATRV"], "--robot belongs to"),
        (["component", "no/such/file.py"], "there is no file"),
    ],
)
def test_what_cannot_be_checked_is_said_in_a_line(
    words: list[str], answer: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert execute(["check", *words]) != 0
    said = capsys.readouterr().err
    assert answer in said
    assert len(said.splitlines()) == 1


def test_files_without_components(tmp_path: Path) -> None:
    file = tmp_path / "empty.py"
    file.write_text("x = 1\n")
    with pytest.raises(SubjectError, match="no class of a component"):
        check_component(file)
    file.write_text(
        "from morse.core.modifier import AbstractModifier\n\n\nclass Coarse(AbstractModifier):\n    _names = ('C',)\n"
    )
    (report,) = check_component(file)
    assert "derived neither from Sensor nor from Actuator nor from Robot" in str(report)
    file.write_text("class A(:\n")
    with pytest.raises(SubjectError, match=r"empty\.py:1: SyntaxError"):
        check_component(file)


def test_an_error_of_the_component_is_not_one_of_its_robot(sonar: Path) -> None:
    sonar.write_text(SOUND.replace('unit="m"', 'unit="cubit"'))
    (report,) = check_component(sonar)
    assert "the unit 'cubit' is unknown" in str(report)
    assert "--robot" not in str(report)


def test_a_property_without_a_range_that_fails_is_named_with_the_mend(sonar: Path) -> None:
    sonar.write_text(
        SOUND.replace("high=10.0", "").replace("self._gain * abs(self.position_3d.x)", "1.0 / (self._gain < 1e6)")
    )
    (report,) = check_component(sonar)
    assert "low= and high=" in report.of("survives bad calls")[0].text


def test_a_state_that_may_be_nothing_is_named_with_its_type(sonar: Path) -> None:
    sonar.write_text(
        SOUND.replace("add_property\n", "add_property, add_state\n")
        .replace("    @service", '    add_state("_goal", float, "Where it looks")\n    _goal = None\n\n    @service')
        .replace("    def default_action(self):\n", "    def default_action(self):\n        self._goal = None\n")
    )
    (report,) = check_component(sonar)
    assert "declare it as float | None" in str(report)


def test_a_robot_is_on_no_robot(tmp_path: Path) -> None:
    (report,) = check_component("FakeRobot")
    assert report.robot == ""
    assert report.passed, str(report)


@pytest.mark.parametrize(
    ("method", "rule"),
    [
        ("default_action(self):\n        raise SystemExit(3)", FITS),
        ("default_action(self):\n        self.local_data = None", FITS),
        ("__init__(self, obj, parent=None):\n        raise SystemExit(3)", LOADS),
        ("get_state(self):\n        raise ValueError('no state')", SAVED),
        ("set_state(self, state):\n        raise ValueError('no state')", SAVED),
    ],
)
def test_what_a_component_raises_is_a_fault(
    tmp_path: Path, capfd: pytest.CaptureFixture[str], method: str, rule: str
) -> None:
    file = tmp_path / "faulty.py"
    file.write_text(
        f"from morse.core.sensor import Sensor\n\n\nclass Faulty(Sensor):\n    _name = 'F'\n\n    def {method}\n"
    )
    (report,) = check_component(file)
    assert report.of(rule)
    assert execute(["check", "component", str(file)]) == 1
    said = capfd.readouterr()
    assert f"NO  {rule}" in said.out
    assert "Traceback" not in said.out + said.err


def test_the_robot_may_be_chosen(sonar: Path) -> None:
    (report,) = check_component(sonar, robot="Pioneer3DX")
    assert report.passed
    assert report.robot == "Pioneer3DX"
    (report,) = check_component("MotionVWDiff", robot="ATRV")
    assert [fault.rule for fault in report.faults] == ["can be put on a robot"]
    assert "has no wheels" in report.faults[0].text


def test_the_message_kinds_of_a_project_are_found(tmp_path: Path) -> None:
    """Its pyproject.toml declares them beside its folder src, which is on the import path only during the check."""
    package = tmp_path / "src" / "weather_lab"
    package.mkdir(parents=True)
    (package / "__init__.py").touch()
    (package / "kinds.py").write_text(
        "from morse.core.kinds import Kind, Slot\n"
        'KINDS = [Kind("lab_wind", {"speed": Slot("speed", unit="m/s")}, True, False, 1, "The wind.")]\n'
    )
    (tmp_path / "pyproject.toml").write_text(
        '[project]\nname = "weather-lab"\nversion = "1"\n\n'
        '[project.entry-points."morse.kinds"]\nweather_lab = "weather_lab.kinds:KINDS"\n'
    )
    file = package / "vane.py"
    file.write_text(
        "import math\n\n"
        "from morse.core.sensor import Sensor\n"
        "from morse.helpers.air import wind\n"
        "from morse.helpers.components import add_data, add_kind\n\n\n"
        "class LabVane(Sensor):\n"
        '    """Measures the speed of the wind."""\n\n'
        '    _name = "Vane"\n'
        '    _short_desc = "Measures the speed of the wind"\n'
        '    add_data("speed", 0.0, "float", "Of the wind", unit="m/s", low=0.0)\n'
        '    add_kind("lab_wind", speed="speed")\n\n'
        "    def measure(self):\n"
        '        """Measure the speed."""\n'
        '        self.local_data["speed"] = math.hypot(*wind(self.context))\n'
    )
    before = list(sys.path)
    (report,) = check_component(file)
    assert report.faults == []
    assert sys.path == before
