"""The lessons: what is handed out fails with hints, a solution passes, and a solution with a fault fails."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from morse.plugins.lessons.attempt import Attempt
from morse.plugins.lessons.catalog import lesson, lessons

SOLUTIONS = Path(__file__).parent / "solutions"
NAMES = sorted(path.stem for path in SOLUTIONS.glob("*.py"))


def findings(name, folder, text):
    (folder / "controller.py").write_text(text, encoding="utf-8")
    attempt = Attempt(lesson(name), folder)
    attempt.run(lambda: None)
    return attempt.findings


def test_there_is_a_solution_of_each():
    found, wrong = lessons()
    assert not wrong
    assert sorted(found) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_solution_passes(name, tmp_path):
    wrong = [f for f in findings(name, tmp_path, (SOLUTIONS / f"{name}.py").read_text()) if not f.is_right]
    assert not wrong


@pytest.mark.parametrize("name", NAMES)
def test_the_file_that_is_handed_out_runs_and_fails_with_a_hint(name, tmp_path):
    points = findings(name, tmp_path, lesson(name).module.START)
    assert not any(f.what in ("The program runs.", "The check runs.") for f in points)
    wrong = [f for f in points if not f.is_right]
    assert wrong
    assert [f.what for f in wrong if not f.hint] == []


@pytest.mark.parametrize(("force", "hint"), [(0.0, "has to rise above 1.5 m"), (60.0, "less force")])
def test_a_lift_that_does_not_rise_is_not_told_to_damp(tmp_path, force, hint):
    points = findings("pid", tmp_path, f"def step(target, height, seconds):\n    return {force}\n")
    (light, heavy) = [f.hint for f in points if "stays below" in f.what]
    assert hint in light
    assert hint in heavy


def test_a_program_that_does_nothing_has_no_points_for_what_it_leaves_out(tmp_path):
    said = {"dock": "drives and touches nothing", "wall": "touches nothing", "gates": "touches nothing"}
    for name, what in {**said, "testing": "It is right about", "tuning": "between 0 and 10"}.items():
        points = [f for f in findings(name, tmp_path, lesson(name).module.START) if what in f.what]
        assert points
        assert not any(f.is_right for f in points), name


def test_a_post_at_the_right_is_not_told_to_be_at_the_left(tmp_path):
    points = findings("dock", tmp_path, lesson("dock").module.START)
    (second, third) = [f.hint for f in points if "looks at it" in f.what][1:]
    assert "the post is 7 degrees to the right" in second
    assert "the post is 127 degrees to the right" in third


@pytest.mark.parametrize(
    ("program", "hint"),
    [
        ("return 19.6 + 8.0 * (target - height)", "needs damping"),
        ("return 60.0", "less force when it is too high"),
        ("return 15.0 * (target - height) - 15.0 * speed(height, seconds) + 0.9 * 19.6", "sum of errors"),
    ],
)
def test_the_hint_of_a_lift_is_of_what_it_lacks(tmp_path, program, hint):
    text = (
        "before = []\n\n\ndef speed(height, seconds):\n    before.append(height)\n"
        "    return (before[-1] - before[-2]) / seconds if len(before) > 1 else 0.0\n\n\n"
        f"def step(target, height, seconds):\n    {program}\n"
    )
    light = next(f for f in findings("pid", tmp_path, text) if "within 2 cm" in f.what)
    assert hint in light.hint


def test_a_way_through_boxes_is_not_told_to_be_long(tmp_path):
    points = findings("planning", tmp_path, lesson("planning").module.START)
    assert [f.hint for f in points if "longer than" in f.what] == ["This counts when it keeps this distance."] * 3


#: lesson, a wrong program, and a pattern of the points that it must not get
WRONG = [
    (
        "mapping",
        "def add(*_):\n    pass\ndef cells():\n    return {(c, r) for c in range(-12, 12) for r in range(-12, 12)}",
        "finds",
    ),
    ("planning", "def plan(boxes, start, goal):\n    return None", ""),
    ("tuning", "def learn(cost):\n    cost(1)\n    return 11", "The gain|worse"),
]


@pytest.mark.parametrize(("name", "text", "what"), WRONG, ids=[name for name, _, _ in WRONG])
def test_a_wrong_program_gets_no_points_of_a_fixed_number(tmp_path, name, text, what):
    points = findings(name, tmp_path, text)
    assert len(points) == len(findings(name, tmp_path, lesson(name).module.START))
    assert not [f.what for f in points if f.is_right and re.search(what, f.what) and "something" not in f.what]


@pytest.mark.parametrize("way", ["[start] * 5000 + [goal]", "[(float('nan'), 0)] * 2", "'way'", "[start]"])
def test_what_is_no_path_is_shown(tmp_path, way):
    (point,) = findings("planning", tmp_path, f"def plan(boxes, start, goal):\n    return {way}\n")
    assert re.search(r"plan\(\) returned .*, expected a list of 2 to 1000 points", point.hint)


def test_a_robot_that_leaves_the_line_is_told_so(tmp_path):
    points = findings("line", tmp_path, "def step(image):\n    return 1.0, 0.0\n")
    assert points[0].hint.startswith("It has lost the line at (")


def test_the_program_under_test_does_not_tell_its_name(tmp_path):
    text = "def is_right(program, drive):\n    drive(program, 5.0)\n    return 'right' in program.__name__\n"
    assert not all(f.is_right for f in findings("testing", tmp_path, text))


def test_what_is_no_truth_value_is_named(tmp_path):
    (point,) = findings("testing", tmp_path, "def is_right(program, drive):\n    return drive(program, 5.0)[2:]\n")
    assert point.hint == "is_right() returned (False,), expected True or False"


#: lesson, a part of the solution, the fault in its place
FAULTS = [
    ("line", "1.4 * error", "-1.4 * error"),
    ("line", "0.9 - 0.5 * abs(error)", "0.2"),
    ("wall", "0.9 * (1.0 - right)", "0.9 * (right - 1.0)"),
    ("wall", "if ahead < 1.4", "if ahead < 0.3"),
    ("pid", "+ self.sum", "+ 0.0"),
    ("pid", "- 18.0 * speed", ""),
    ("odometry", "yaw + turn / 2", "yaw"),
    ("odometry", "math.remainder(yaw + turn, math.tau)", "yaw + turn"),
    ("odometry", "seconds**2 / 2", "seconds**2"),
    ("dock", "width >= 14", "width >= 40"),
    ("dock", "return 0.0, 0.6", "return 0.0, 0.0"),
    ("traffic", "from_right and theirs < 2.5", "False and theirs < 2.5"),
    ("traffic", "from_right and theirs < 2.5", "theirs < 2.5"),
    ("mapping", "yaw + math.radians(k - 180)", "math.radians(k - 180)"),
    ("mapping", "distance < 19.9", "True"),
    ("planning", "> 0.52", "> 0.0"),
    ("planning", "return None", "return [start, goal]"),
    ("gates", "math.sin(yaw), z)", "math.sin(yaw), z + 1.1)"),
    ("tuning", "min(costs)", "max(costs)"),
    ("testing", "(5.0, 0.3)", "(5.0,)"),
    ("testing", "max(map(abs, speeds)) > 1.0", "False"),
    ("search", "visited.get(cell, 0) + 1", "1000"),
]


@pytest.mark.parametrize(("name", "part", "fault"), FAULTS)
def test_a_planted_fault_is_found(name, part, fault, tmp_path):
    text = (SOLUTIONS / f"{name}.py").read_text()
    assert part in text
    points = findings(name, tmp_path, text.replace(part, fault))
    assert any(not f.is_right for f in points)


@pytest.mark.parametrize("name", NAMES)
def test_the_scene_script_is_complete(name, tmp_path):
    import morse

    lesson(name).write(tmp_path / name)
    with morse.load(tmp_path / name / "scene.py", on_warning="raise") as simulation:
        simulation.step(2)
    shutil.rmtree(tmp_path / name)
