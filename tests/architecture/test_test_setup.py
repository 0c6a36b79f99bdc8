"""Assumptions of the tests."""

import os
import shutil
import signal
import socket
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

from tests.kit.programs import python

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

PERSON = """
import importlib.util, json, locale, os, pathlib, subprocess, sys
from morse.cli.sites import registered

PROGRAM = (
    "import json, locale, os, sys; from morse.cli.sites import registered;"
    "language = locale.getencoding().lower();"
    "print(json.dumps([registered(), sorted(os.environ), language, os.listdir(), 'spam' in sys.path]))"
)

def test_nothing_of_the_person_is_seen():
    assert registered() == []
    assert not {name for name in os.environ if name.startswith(("LC_ALL", "LANG", "PYTHON"))}
    assert os.environ["ROS_DOMAIN_ID"] != "107"
    assert os.listdir() == []
    assert "spam" not in sys.path
    assert importlib.util.find_spec("ranger_sim") is None, "neither in the home directory nor beside the tests"
    said = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=True)
    projects, variables, encoding, files, spam = json.loads(said.stdout)
    assert (projects, files, spam) == ([], [], False)
    assert encoding == "utf-8"
    assert not {"MORSE_THREADS", "MORSE_NODE", "LC_ALL", "PYTHONWARNINGS", "DISPLAY"} & set(variables)

def test_a_project_that_the_person_has(tmp_path):
    (tmp_path / "scene.py").write_text("from ranger_sim.builder import Ranger")
    command = [sys.executable, "-m", "morse", "run", "scene.py"]
    said = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert "folder 'src'" in said.stdout + said.stderr, "MORSE knows nothing of a registered project"
"""


def test_files_of_tests_have_names_of_their_own() -> None:
    """pytest imports them by their names: a second one stops the collection."""
    places = Counter(path.name for path in TESTS.rglob("*.py") if path.name not in ("conftest.py", "__init__.py"))
    assert [name for name, count in places.items() if count > 1] == []


def run_pytest(*arguments: str, folder: Path = TESTS.parent, **environment: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "-q", "-n", "0", "-p", "no:cacheprovider", *arguments]
    return subprocess.run(
        command, cwd=folder, env={**os.environ, **environment}, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize("workers", [0, 1])
def test_tests_see_nothing_of_the_person_who_runs_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, workers: int
) -> None:
    """Projects, settings, a locale and files of a person; in the process of pytest and in a worker."""
    home, folder = tmp_path / "home", tmp_path / "folder"
    (project := home / "ranger_sim" / "src" / "ranger_sim" / "builder").mkdir(parents=True)
    (project / "__init__.py").write_text("Ranger = print\n")
    (home / ".morse").mkdir()
    (home / ".morse" / "config").write_text(f"[sites]\nranger_sim = {home / 'ranger_sim'}\n")
    (tests := folder / "tests").mkdir(parents=True)
    (folder / "scene.py").write_text("1 / 0\n")
    (folder / "ranger_sim").mkdir()
    (tests / "test_person.py").write_text(PERSON)
    shutil.copy(TESTS / "conftest.py", tests)
    shutil.copytree(TESTS / "kit", tests / "kit")
    # as if nobody had begun a run of tests
    for name in ("MORSE_TEST_SESSION", "PYTEST_XDIST_WORKER", "PYTEST_XDIST_TESTRUNUID"):
        monkeypatch.delenv(name, raising=False)
    done = run_pytest(
        f"-n{workers}", "-c", os.devnull, f"--rootdir={folder}", "tests",
        folder=folder, HOME=str(home), USERPROFILE=str(home), MORSE_THREADS="1", MORSE_NODE="other", MORSE_CACHE="off",
        MORSE_RESOURCE_PATH=str(home), MORSE_SOCKET_PORT="4000", PYTHONPATH="spam", PYTHONWARNINGS="ignore",
        ROS_DOMAIN_ID="107", LC_ALL="tr_TR.ISO-8859-9", LANG="de_DE.ISO-8859-1", DISPLAY=":7",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2 passed" in done.stdout


def test_each_run_of_tests_has_ports_that_no_program_uses() -> None:
    """Also two at once with the same number, beside a program that listens on one of these ports."""
    tried = "import conftest, os; print(os.environ['MORSE_SOCKET_PORT'], flush=True); input()"
    settings = {**os.environ, "PYTEST_XDIST_WORKER": "gw0", "PYTEST_XDIST_TESTRUNUID": "ff", "PYTHONPATH": str(TESTS)}

    def begin() -> subprocess.Popen[str]:
        return subprocess.Popen(
            [sys.executable, "-c", tried], env=settings, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def port(run: subprocess.Popen[str]) -> int:
        assert run.stdout is not None
        return int(run.stdout.readline())

    with begin() as first, begin() as second:
        ports = {port(first), port(second)}
        for run in (first, second):
            run.communicate("\n")
    assert len(ports) == 2
    with socket.socket() as program:
        program.bind(("127.0.0.1", min(ports) + 50))
        program.listen()
        with begin() as third:
            assert port(third) != min(ports)
            third.communicate("\n")


def test_children_can_be_interrupted() -> None:
    done = python("-c", INTERRUPTED)
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
