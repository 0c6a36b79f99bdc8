"""``morse check SCENE``: everything that needs a change at once, and a mended copy."""

from dataclasses import replace

import pytest

from morse.middleware import registry
from tests.cli.conftest import Terminal

HEAD = "from morse.builder import *\n"
END = "env = Environment('empty')\n"


def lines_of(out: str, name: str = "old.py") -> dict[int, str]:
    """The findings by line."""
    found: dict[int, str] = {}
    for text in out.splitlines():
        if text.startswith(f"{name}:"):
            _, number, message = text.split(":", 2)
            found[int(number)] = found.get(int(number), "") + message
    return found


@pytest.fixture
def check(morse: Terminal):
    def run(text: str, *options: str):
        (morse.directory / "old.py").write_text(text)
        return morse("check", "old.py", *options)

    return run


def test_a_script_without_old_forms(check) -> None:
    answer = check(f"{HEAD}robot = ATRV()\n{END}")
    assert (answer.status, lines_of(answer.out)) == (0, {})
    assert answer.out.splitlines()[-1] == "* old.py runs."


def test_every_error_is_listed_with_its_line(check) -> None:
    answer = check(
        HEAD
        + "bad = Robot('no_such_robot')\n"
        + "bad.translate(1)\n"
        + "bad.append(Pose())\n"
        + "robot = ATRV()\n"
        + "robot.trnslate(z=0.1)\n"
        + "for i in range(2):\n"
        + "    pose = Pose()\n"
        + "    robot.append(pose)\n"
        + "    pose.add_stream('pocolibs')\n"
        + "thing = Thingy()\n"
        + "robot.append(thing)\n"
        + "print 'ready'\n"
        + END
        + "env.set_gravty(9)\n"
    )
    found = lines_of(answer.out)
    expected = {
        2: "no model 'no_such_robot'",
        6: "'translate'",
        10: "ros2",
        11: "'Thingy' is not defined",
        13: "print(...)",
        15: "'set_gravity'",
    }
    assert set(found) == set(expected), "a line that fails only because of an earlier one is not listed"
    for line, words in expected.items():
        assert words in found[line]
        assert "error: " in found[line]
    assert answer.status == 1
    assert answer.out.splitlines()[-1] == "* old.py does not run."


def test_consequences_on_lines_of_several_statements_are_not_listed(check) -> None:
    answer = check(
        f"{HEAD}bad = Robot('no_such_robot'); bad.translate(1)\n"
        + "cube = Cube(); bad.append(cube); cube.translate(z=1)\n"
        + "robot = ATRV(); bad.append(robot); robot.trnslate(z=0.1)\n"
        + END
    )
    found = lines_of(answer.out)
    assert set(found) == {2, 4}
    assert "no model 'no_such_robot'" in found[2]
    assert "'translate'" in found[4]
    assert "'bad'" not in answer.out


def test_old_forms_are_listed_and_the_script_runs(check) -> None:
    answer = check(
        HEAD
        + "from morse.builder.robots.pr2 import *\n"
        + "import time\n"
        + "start = time.clock()\n"
        + "print('this is not shown')\n"
        + "robot = ATRV()\n"
        + "robot.translate(x='1')\n"
        + "pose = Pose()\n"
        + "robot.append(pose)\n"
        + "pose.configure_mw('socket')\n"
        + END
        + "env.aim_camera([1, 0, 0])\n"
    )
    found = lines_of(answer.out)
    for line, new in (
        (2, "morse.builder.robots"),
        (4, "time.perf_counter"),
        (7, "write 1"),
        (10, "add_stream"),
        (12, "set_camera_rotation"),
    ):
        assert new in found.pop(line)
    assert not found
    assert "this is not shown" not in answer.out
    assert answer.status == 0
    assert answer.out.splitlines()[-1] == "* old.py runs."


def test_the_copy_is_mended_and_the_original_stays(check, morse: Terminal) -> None:
    old = (
        HEAD
        + "import sys\n"
        + "from fractions import gcd, Fraction\n"
        + "from collections import Mapping\n"
        + "words = sys.argv[sys.argv.index('--') + 1:]\n"
        + "print 'words', words\n"
        + "robot = ATRV()\n"
        + "for i in xrange(gcd(2, 4)):\n"
        + "    robot.translate(x='0.5')\n"
        + "pose = Pose()\n"
        + "robot.append(pose)\n"
        + "pose.configure_mw('socket')\n"
        + "try:\n"
        + "    assert isinstance({}, Mapping) and 1 <> 2\n"
        + "except ValueError, error:\n"
        + "    pass\n"
        + "env = Environment('empty', fastmode='yes')\n"
        + "env.configure_multinode(distribution={'a': \"robot\"})\n"
        + "env.place_camera([1, 0, 0])\n"
    )
    answer = check(old, "--fix")
    assert answer.status == 1, "the original does not run"
    assert (morse.directory / "old.py").read_text() == old
    copy = morse.directory / "old_fixed.py"
    assert "which runs" in answer.out
    again = morse("check", str(copy))
    assert again.status == 0
    assert not lines_of(again.out, "old_fixed.py"), copy.read_text()
    text = copy.read_text()
    for new in ("from math import gcd", "from fractions import Fraction", "sys.argv[1:]", "fastmode=True", "['robot']"):
        assert new in text
    assert check(old, "--fix").status == 1
    assert copy.read_text() == text, "files are not overwritten"
    assert (morse.directory / "old_fixed_2.py").exists()


@pytest.mark.parametrize("declared", ["# -*- coding: latin-1 -*-\n", ""])
def test_the_copy_of_a_script_in_latin_1_keeps_its_letters(morse: Terminal, declared: str) -> None:
    """Python 2 took the letters of a script without a declaration as they were."""
    old = f"{declared}# café\n{HEAD}print 'café'\nrobot = ATRV()\n{END}"
    (morse.directory / "old.py").write_bytes(old.encode("latin-1"))
    morse("check", "old.py", "--fix")
    copy = (morse.directory / "old_fixed.py").read_bytes().decode("latin-1" if declared else "utf-8")
    assert "# café\n" in copy
    assert "print('café')" in copy


def test_a_script_with_tabs_and_spaces(check, morse: Terminal) -> None:
    answer = check(f"{HEAD}for i in range(2):\n\trobot = ATRV()\n        robot.translate(x=i)\n{END}", "--fix")
    assert "spaces" in lines_of(answer.out)[4]
    assert "which runs" in answer.out
    assert "\t" not in (morse.directory / "old_fixed.py").read_text()


@pytest.mark.parametrize(
    "text", ["robot = (\n", "def f(:\n    pass\n", "\x00", "'''\n", "  x = 1\n", "class A:\n", "λ = $\n"]
)
def test_damaged_scripts_end_with_a_line(check, text: str) -> None:
    answer = check(HEAD + text + END)
    assert answer.status == 1
    assert answer.out.splitlines()[-1] == "* old.py does not run."
    assert "Traceback" not in answer.out + answer.err


def test_errors_of_components_when_they_are_loaded(check, morse: Terminal) -> None:
    package = morse.directory / "src" / "lab" / "sensors"
    package.mkdir(parents=True)
    for folder in (package, package.parent):
        (folder / "__init__.py").write_text("")
    (package / "thing.py").write_text(
        "from morse.core.sensor import Sensor\nclass Thing(Sensor):\n    _name = 'Thing'\n"
        "    def __init__(self, obj, parent=None):\n        super().__init__(obj, parent)\n        1 / 0\n"
        "    def default_action(self):\n        pass\n"
    )
    answer = check(
        f"{HEAD}from lab.builder.sensors import Thing\nrobot = ATRV()\nthing = Thing()\nrobot.append(thing)\n{END}"
    )
    assert answer.status == 1
    assert "thing.py" in answer.out


def test_mistakes_on_the_command_line(morse: Terminal) -> None:
    assert "neither a registered environment nor a file" in morse("check", "nothing.py").err
    assert "component" in morse("check", "componnt").err
    assert morse("check", "--fix").status == 2


@pytest.mark.parametrize(
    "use", ["pose.add_stream('ros')", "robot.add_default_interface('ros')", "env.add_service('ros')"]
)
def test_a_middleware_that_cannot_connect_does_not_run(check, monkeypatch: pytest.MonkeyPatch, use: str) -> None:
    ros = replace(registry.middleware("ros"), modules=("no_such_rospy",))
    monkeypatch.setattr(registry, "installed", lambda: {"ros": ros})
    text = f"{HEAD}robot = ATRV()\npose = Pose()\nrobot.append(pose)\n"
    text += f"{END}{use}\n" if use.startswith("env") else f"{use}\n{END}"
    answer = check(text)
    assert answer.status == 1
    number = 1 + next(i for i, line in enumerate(text.splitlines()) if "'ros'" in line)
    # services belong to the environment; a robot connects its components, of which the first is named
    number = {"robot.add_default_interface('ros')": 3, "env.add_service('ros')": 5}.get(use, number)
    assert f"old.py:{number}: error: ros: the Python module 'no_such_rospy' is not installed. To install" in answer.out
    assert "add_stream('ros2') for ROS 2, or add_stream('rosbridge')" in answer.out
    assert answer.out.splitlines()[-1] == "* old.py does not run."


def test_nodes_by_hla_do_not_run(check) -> None:
    answer = check(f"{HEAD}robot = ATRV()\n{END}env.configure_multinode(protocol='hla')\n")
    assert "use protocol='socket'" in lines_of(answer.out)[4]
    assert answer.status == 1


def test_texts_for_the_numbers_of_axes(check, morse: Terminal) -> None:
    script = f"{HEAD}robot = ATRV()\nimu = IMU()\nrobot.append(imu)\n"
    script += "imu.alter('Noise', accel_std={'x': '0.1', 'y': 0.2})\n"
    answer = check(script + END, "--fix")
    assert "(x) takes a number, got the text '0.1'; write 0.1" in lines_of(answer.out)[5]
    assert answer.status == 0
    assert "{'x': 0.1, 'y': 0.2}" in (morse.directory / "old_fixed.py").read_text()
