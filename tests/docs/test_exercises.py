"""The checkers of the exercises pass with a solution, and fail with the files as they are handed out."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from doc_pages import DOCS
from exercise_solutions import SOLUTIONS

PAGE = (DOCS / "exercises.md").read_text(encoding="utf-8")
FILES: dict[str, str] = dict(re.findall(r"`(tests/\w+\.py)`:\n\n```python\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL))
#: tests that nothing has to be done for: there is no ball, and the right program is right
_FREE = {"test_see.py::test_it_finds_the_ball[place4]", "test_examine.py::test_the_right_program_passes"}


def outcomes(project: Path, files: dict[str, str]) -> dict[str, set[str]]:
    """The tests that pass and fail in a project with these files."""
    (project / "tests").mkdir()
    for name, text in {"conftest.py": 'pytest_plugins = ["morse.testing.fixtures"]\n', **files}.items():
        (project / name).write_text(text, encoding="utf-8")
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-rA",
        "--tb=line",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:xdist",
        "tests",
    ]
    done = subprocess.run(command, cwd=project, capture_output=True, text=True, timeout=240, check=False)
    lines = re.findall(r"^(PASSED|FAILED|ERROR) tests/(\S+)", done.stdout, re.MULTILINE)
    assert lines, done.stdout + done.stderr
    return {state: {name for found, name in lines if found == state} for state in ("PASSED", "FAILED", "ERROR")}


def test_there_are_five() -> None:
    assert len(re.findall(r"^## ", PAGE, re.MULTILINE)) == len(SOLUTIONS) == 5
    assert FILES.keys() == SOLUTIONS.keys() | {name.replace("tests/", "tests/test_") for name in SOLUTIONS}


@pytest.mark.long
def test_a_solution_passes(tmp_path: Path) -> None:
    states = outcomes(tmp_path, {**FILES, **SOLUTIONS})
    assert not states["FAILED"] | states["ERROR"]
    assert len(states["PASSED"]) == 12


@pytest.mark.long
def test_the_files_as_they_are_handed_out_do_not(tmp_path: Path) -> None:
    states = outcomes(tmp_path, FILES)
    assert states["PASSED"] == _FREE
    assert len(states["FAILED"]) == 10
