"""Assumptions of the tests."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

TESTS = Path(__file__).resolve().parents[1]
INTERRUPTED = """
import os, signal
try:
    os.kill(os.getpid(), signal.SIGINT)
except KeyboardInterrupt:
    print("interrupted")
"""
TEXTS = """
import os, pathlib
from hypothesis import given, strategies as st

def test_the_table_is_there():
    assert list(pathlib.Path(os.environ["HYPOTHESIS_STORAGE_DIRECTORY"]).rglob("charmap*"))

@given(st.text())
def test_texts(text):
    assert isinstance(text, str)
"""


def test_files_of_tests_have_names_of_their_own() -> None:
    """pytest imports them by their names: a second one stops the collection."""
    places = Counter(path.name for path in TESTS.rglob("*.py") if path.name not in ("conftest.py", "__init__.py"))
    assert [name for name, count in places.items() if count > 1] == []


def run_pytest(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *arguments]
    return subprocess.run(
        command, cwd=TESTS.parent, env={**os.environ, **environment}, capture_output=True, text=True, check=False
    )


def test_children_can_be_interrupted() -> None:
    done = subprocess.run([sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == "interrupted\n"


@pytest.mark.skipif(sys.platform == "win32", reason="background jobs of a POSIX shell")
def test_children_can_be_interrupted_in_a_background_job() -> None:
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        done = run_pytest(f"{__file__}::test_children_can_be_interrupted")
    finally:
        signal.signal(signal.SIGINT, before)
    assert done.returncode == 0, done.stdout


def test_the_first_text_of_hypothesis_is_no_slower_than_others(tmp_path: Path) -> None:
    """With an empty directory, hypothesis has to create its table of characters."""
    (tmp_path / "test_texts.py").write_text(TEXTS)
    (tmp_path / "conftest.py").write_text((TESTS / "conftest.py").read_text())
    done = run_pytest(
        "--hypothesis-seed=1", "-c", os.devnull, f"--rootdir={tmp_path}", str(tmp_path),
        HYPOTHESIS_STORAGE_DIRECTORY=str(tmp_path / "table"),
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert "2 passed" in done.stdout
