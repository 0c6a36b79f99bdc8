"""``morse lesson``: lists, starts and checks; programs that crash, hang or return nonsense get a hint."""

from __future__ import annotations

import csv
import json
import re
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from websockets.sync.client import connect

from morse.cli.app import execute
from morse.plugins.lessons.attempt import Attempt
from morse.plugins.lessons.catalog import lesson
from morse.plugins.lessons.course import ORDER
from morse.plugins.lessons.examining import examine
from morse.viewer.protocol import VERSION
from tests.kit.waiting import wait_until

SOLUTIONS = Path(__file__).parent / "solutions"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_all_lessons_are_listed(here, capsys):
    assert execute(["lesson"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split(None, 1) == ["line", "Follow a line"]
    assert sum(line.split(None, 1)[0] in ORDER for line in lines if line) == len(ORDER)


def test_a_lesson_is_started_checked_and_passed(here, capfd):
    assert execute(["lesson", "start", "odometry"]) == 0
    assert sorted(path.name for path in (here / "odometry").iterdir()) == ["README.md", "controller.py", "scene.py"]
    assert execute(["lesson", "check", "odometry"]) == 1
    assert "[WRONG] The yaw is right within 0.01 rad." in capfd.readouterr().out
    shutil.copy(SOLUTIONS / "odometry.py", here / "odometry" / "controller.py")
    assert execute(["lesson", "check", "odometry"]) == 0
    assert "6 of 6 points. Passed." in capfd.readouterr().out


def test_the_page_shows_the_task_and_what_is_missing_and_checks_again_what_is_saved(here):
    assert execute(["lesson", "start", "odometry"]) == 0
    log = here / "log"
    with log.open("w") as output:
        command = [sys.executable, "-c", "from morse.cli import main; main()", "lesson", "show", "odometry"]
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
    try:
        url = wait_until(lambda: re.search(r"http://\S+", log.read_text()), "the address")[0]

        def task():
            with connect(f"{url.replace('http', 'ws')}ws", max_size=None) as page:
                page.send(json.dumps({"type": "hello", "version": VERSION}))
                while True:
                    frame = page.recv(timeout=60)
                    message = json.loads(frame) if isinstance(frame, str) else {}
                    if message.get("type") == "task":
                        return message

        wait_until(lambda: "Save" in log.read_text(), "the first result")
        shown = task()
        assert shown["title"] == lesson("odometry").title
        assert shown["text"] == lesson("odometry").task
        assert shown["is_checked"]
        assert {"what": "The yaw is right within 0.01 rad.", "is_right": False} in [
            {name: value for name, value in point.items() if name != "hint"} for point in shown["points"]
        ]
        shutil.copy(SOLUTIONS / "odometry.py", here / "odometry" / "controller.py")
        wait_until(lambda: "Passed." in log.read_text(), "the second result")
        # at the same address, to which the open page connects again
        again = task()
        assert again["points"]
        assert all(point["is_right"] for point in again["points"])
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def shown(tmp_path):
    attempt = Attempt(lesson("odometry"), tmp_path, is_shown=True)
    yield attempt
    attempt.close()


def test_the_robot_stands_when_the_check_has_ended(shown, tmp_path):
    # the last command of the check would drive it on
    (tmp_path / "controller.py").write_text("def update(way, turn):\n    return (0, 0, 0) if way < 0.05 else None\n")
    shown.run(lambda: None)
    assert "returned None" in shown.findings[0].hint
    robot = shown.simulation.robot
    before = robot.pose.data["x"]
    assert before > 0.01
    threading.Timer(1.0, lambda: (tmp_path / "controller.py").write_text("x = 1\n")).start()
    assert shown.wait_for_change()
    assert robot.pose.data["x"] == before


def test_a_program_that_is_saved_during_the_check_is_checked_at_once(shown, tmp_path):
    save = "    pathlib.Path(__file__).write_text('x = 1')\n"
    (tmp_path / "controller.py").write_text(f"import pathlib\ndef update(way, turn):\n{save}    return 0, 0, 0\n")
    shown.run(lambda: None)
    assert shown.simulation.clock.time < 1.0
    assert shown.findings == []
    assert shown.wait_for_change()
    shown.again(lambda: None)
    assert [point.hint for point in shown.findings] == [
        "controller.py has no function update(): it may have been renamed"
    ]


def test_the_program_of_a_student_is_not_overwritten(here, capsys):
    assert execute(["lesson", "start", "line"]) == 0
    (here / "line" / "controller.py").write_text("mine = 1\n")
    assert execute(["lesson", "start", "line"]) == 1
    assert (here / "line" / "controller.py").read_text() == "mine = 1\n"
    assert "exists already" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["lesson", "check"], "which lesson?"),
        (["lesson", "check", "lin"], "did you mean 'line'"),
        (["lesson", "line"], "do you mean `morse lesson start line`"),
        (["lesson", "chek", "line"], "expected start, show, check, task"),
        (["lesson", "check", "wall"], "`morse lesson start wall` writes it"),
        (["lesson", "check", "../../etc"], "there is no lesson"),
        (["lesson", "--class", "nowhere"], "there is no folder nowhere"),
    ],
)
def test_wrong_words_get_the_right_ones(here, capsys, words, said):
    assert execute(words) == 1
    assert said.lower() in capsys.readouterr().err.lower()


@pytest.mark.parametrize(
    ("program", "hint"),
    [
        ("def step(image:\n", "line 1"),
        ("import sys\nsys.exit(0)\n", "SystemExit"),
        ("x = 1\n", "has no function step()"),
        ("def step():\n    return 0, 0\n", "step() takes 0 positional arguments"),
        ("def step(image):\n    return image.no_such\n", 'controller.py", line 2'),
        ("def step(image):\n    return None\n", "step() returned None, expected 2 numbers"),
        ("def step(image):\n    return float('nan'), 0\n", "expected 2 numbers, not infinite and not NaN"),
        ("def step(image):\n    bytearray(6 * 10**9)\n", "MemoryError"),
        ("def step(image):\n    return 1, 2, 3\n", "expected 2 numbers"),
        ("def step(image):\n    while True:\n        yield 1\n", "yields more than 100,000 items"),
        (
            "import os, sys\nhasattr(os, 'mkfifo') and os.mkfifo(sys.argv[3])\ndef step(image):\n    os._exit(0)\n",
            "ended with status",
        ),
        ("def step(image):\n    return step(image)\n", "RecursionError"),
        ("import os\ndef step(image):\n    os._exit(0)\n", "its process ended with status 0"),
        ("def step(image):\n    raise BaseException('\\x1b[31m')\n", "BaseException"),
    ],
)
def test_a_faulty_program_gets_a_hint(tmp_path, program, hint):
    (tmp_path / "controller.py").write_text(program, encoding="utf-8")
    result = examine(lesson("line"), tmp_path, is_quiet=True)
    assert not result.is_passed
    assert hint in " ".join(finding.hint for finding in result.findings)
    assert "Traceback" not in " ".join(finding.hint for finding in result.findings)


def test_an_endless_loop_is_named_with_its_line(tmp_path):
    (tmp_path / "controller.py").write_text("def step(image):\n    while True:\n        pass\n")
    code = (
        "import sys; from morse.plugins.lessons import attempt, examining; attempt.LONGEST_CALL = 0.5;"
        "examining.main(sys.argv[1:])"
    )
    file = tmp_path / "findings.json"
    done = subprocess.run(
        [sys.executable, "-c", code, "line", str(tmp_path), str(file)], timeout=120, check=False, capture_output=True
    )
    assert done.returncode == 1
    (finding,) = json.loads(file.read_text())
    assert re.search(r"it is in line [23] of controller.py. Is this an endless loop", finding["hint"])


#: programs of which each call drives longer than a call may compute, or waits longer than it may wait
SLOW = [
    ("for _ in range(8):\n        drive(lambda d: hard(d - 1.0), 3.0)", "LONGEST_CALL = 0.25", None),
    ("hard(2.0)", "LONGEST_CALL = 0.25", "has not returned after 0.25 s"),
    ("time.sleep(600)", "_LONGEST_WAIT = 0.5", "What does it wait for?"),
    (
        "for _ in range(50):\n        drive(lambda d: hard(d - 1.0), 3.0)",
        "LONGEST_CHECK = 3.0",
        "has not ended after 3 s",
    ),
]


@pytest.mark.parametrize(("body", "limit", "hint"), SLOW)
def test_calls_are_limited_and_what_they_drive_is_not(tmp_path, body, limit, hint):
    (tmp_path / "controller.py").write_text(
        "import time\n\n\ndef hard(x):\n    end = time.process_time() + (0.001 if x < 2.0 or x > 2.0 else 60.0)\n"
        "    while time.process_time() < end:\n        pass\n    return max(-1.0, min(1.0, x))\n\n\n"
        f"def is_right(program, drive):\n    {body}\n    return True\n"
    )
    code = (
        f"import sys; from morse.plugins.lessons import attempt, examining; attempt.{limit};"
        "examining.main(sys.argv[1:])"
    )
    file = tmp_path / "findings.json"
    subprocess.run(
        [sys.executable, "-c", code, "testing", str(tmp_path), str(file)], timeout=300, check=False, capture_output=True
    )
    hints = " ".join(point["hint"] for point in json.loads(file.read_text()))
    assert "returned" not in hints and "ended" not in hints if hint is None else hint in hints


@pytest.mark.skipif(sys.platform == "win32", reason="processes have groups on POSIX systems")
def test_what_a_program_leaves_behind_ends_with_the_check(tmp_path):
    import fcntl

    lock, held = tmp_path / "lock", tmp_path / "held"
    child = (
        f"import fcntl, pathlib, time; file = open({str(lock)!r}, 'w'); fcntl.flock(file, fcntl.LOCK_EX); "
        f"pathlib.Path({str(held)!r}).touch(); time.sleep(600)"
    )
    (tmp_path / "controller.py").write_text(
        "import pathlib, subprocess, sys, threading, time\n"
        f"subprocess.Popen([sys.executable, '-c', {child!r}])\n"
        f"while not pathlib.Path({str(held)!r}).exists():\n    time.sleep(0.01)\n"
        "threading.Thread(target=time.sleep, args=(600,)).start()\n"
        "def step(image):\n    return 'nothing'\n"
    )
    result = examine(lesson("line"), tmp_path, is_quiet=True, seconds=200)
    assert "expected 2 numbers" in " ".join(finding.hint for finding in result.findings)

    def is_free():
        with lock.open("w") as file:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                return False
            return True

    wait_until(is_free, "the child of the program has ended")


def test_names_of_files_here_do_not_matter(here):
    (here / "json.py").write_text("raise SystemExit('json of a student')\n")
    (here / "controller.py").write_text("def step(image):\n    return 0, 0\n")
    hints = [finding.hint for finding in examine(lesson("line"), here, is_quiet=True).findings]
    assert not any("ended with status" in hint for hint in hints), hints


@pytest.mark.parametrize("name", ["README.md", "scene.py"])
def test_files_of_others_are_not_overwritten(here, capsys, name):
    (here / name).write_text("of my project\n")
    assert execute(["lesson", "start", "line", "--folder", "."]) == 1
    assert f"{name} exists already" in capsys.readouterr().err
    assert [path.name for path in here.iterdir()] == [name]
    assert (here / name).read_text() == "of my project\n"


def test_a_class_gets_a_table(here, capsys):
    for student, text in (
        ("anna", (SOLUTIONS / "odometry.py").read_text()),
        ("=HYPERLINK(1)", "x = 1\n"),
        ("carl", "def update(way, turn):\n    return 0, 0, 0\ndef drift(a, b, c):\n    return a * b * c**2 / 2\n"),
        ("gil", "def update(way, turn):\n    return 0, 0, 0\ndef drift(a, b, c):\n    raise KeyError('gain')\n"),
    ):
        folder = here / "results" / student / "odometry"
        folder.mkdir(parents=True)
        (folder / "controller.py").write_text(text)
    misspelt = here / "results" / "dora" / "odometri"
    misspelt.mkdir(parents=True)
    (misspelt / "controller.py").write_text("x = 1\n")
    (here / "results" / "emil" / "homework" / "odometry").mkdir(parents=True)
    (here / "results" / "emil" / "homework" / "odometry" / "controller.py").write_text("x = 1\n")
    (here / "results" / "fina" / "odometry").mkdir(parents=True)
    (here / "results" / "fina" / "odometry" / "solution.py").write_text("x = 1\n")
    assert execute(["lesson", "--class", "results"]) == 0
    rows = list(csv.reader((here / "results" / "lessons.csv").open(encoding="utf-8")))
    assert rows == [
        ["student", "odometry"],
        ["'=HYPERLINK(1)", "error"],
        ["anna", "6 of 6"],
        ["carl", "2 of 6"],
        ["dora", "–"],
        ["emil", "–"],
        ["fina", "–"],
        ["gil", "error"],
    ]
    said = capsys.readouterr()
    assert "anna" in said.out
    assert re.search(
        r"dora.odometri.controller\.py: there is no lesson 'odometri'; did you mean 'odometry'\?", said.err
    )
    assert "=HYPERLINK(1), odometry: error: controller.py has no function update()" in said.err
    assert "gil, odometry: error: KeyError: 'gain'" in said.err  # not the first wrong point
    assert "carl, odometry: 2/6; wrong: The yaw is right within 0.01 rad. It is up to" in said.err
    assert re.search(r"results.emil has no program: .*, but there is results.emil.homework.odometry", said.err)
    assert re.search(r"there is no file results.fina.odometry.controller\.py", said.err)
    assert "Warning: results" in said.err
    assert not re.search(r"Warning: results.anna", said.err)


LESSON = '''
"""Drive to 2 m.

Drive straight ahead, to x = 2 m.
"""

START = """
def speed(x):
    return 0.0
"""


def scene():
    from morse.builder import ATRV, Environment, MotionVW, Pose

    robot = ATRV("robot")
    robot.append(MotionVW("motion"))
    robot.append(Pose("pose"))
    Environment("empty")


def check(attempt):
    robot = attempt.simulation.robot
    for _ in range(50):
        robot.motion.publish({"v": attempt.number("speed", robot.pose.data["x"]), "w": 0.0})
        attempt.step(0.1)
    x = robot.pose.data["x"]
    attempt.expect(abs(x - 2.0) < 0.1, "The robot is at x = 2 m.", f"It is at x = {x:.1f} m.")
'''


@pytest.fixture
def course(here, monkeypatch):
    """A course of a teacher, in a project."""
    (here / "src/my_course").mkdir(parents=True)
    (here / "src/my_course/__init__.py").touch()
    (here / "src/my_course/two_metres.py").write_text(LESSON.lstrip())
    (here / "pyproject.toml").write_text(
        '[project]\nname = "my-course"\n\n[project.entry-points."morse.lessons"]\nmine = "my_course"\n'
    )
    for name in [name for name in sys.modules if name.partition(".")[0] == "my_course"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setattr(sys, "path", list(sys.path))
    return here


def test_a_teacher_adds_lessons(course, capsys):
    assert execute(["lesson"]) == 0
    assert "two_metres  Drive to 2 m" in capsys.readouterr().out
    assert execute(["lesson", "start", "two_metres"]) == 0
    assert execute(["lesson", "check", "two_metres"]) == 1
    (course / "two_metres/controller.py").write_text("def speed(x):\n    return 1.0 if x < 1.97 else 0.0\n")
    assert execute(["lesson", "check", "two_metres"]) == 0


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("raise OSError('no')", "OSError: no"),
        ("import sys; sys.exit()", "SystemExit"),
        ('"""X."""', "it lacks scene, check, START"),
        ("def check(", "SyntaxError"),
    ],
)
def test_a_broken_lesson_is_named_and_the_others_work(course, capsys, text, said):
    (course / "src/my_course/broken.py").write_text(text)
    assert execute(["lesson"]) == 1
    output = capsys.readouterr()
    assert "Follow a line" in output.out
    assert said in output.err
