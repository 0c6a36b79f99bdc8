"""Folders of results of studies are data: nothing in them is executed, waited for or followed."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from morse.many import Study, Table
from morse.many.results import Ledger, read_rows
from morse.many.run import Run, run_once
from morse.many.summary import histogram, scatter, write_summary
from morse.many.values import plain

if sys.platform == "win32":
    pytest.skip("has neither pipes with names nor copies of processes", allow_module_level=True)

STUDY = """
from morse.many import Study

def scene():
    from morse.builder import Environment, FakeRobot
    FakeRobot("robot")
    Environment("empty")

def run(sim, gain):
    sim.step(2)
    return {"x": gain}

study = Study(scene, run, gain=[1.0, 2.0])
"""


def _study(result: Any = 1.0) -> Study:
    def scene() -> None:
        from morse.builder import Environment, FakeRobot

        FakeRobot("robot")
        Environment("empty")

    def run(sim: Any) -> Any:
        sim.step(1)
        if isinstance(result, Exception):
            raise result
        return {"x": result}

    return Study(scene, run, seeds=2)


@pytest.fixture(scope="module")
def row() -> dict[str, Any]:
    return run_once(_study(), Run("0123456789ab", {}, 0))


def _sweep(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "morse", "sweep", *words]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=False)


def test_a_folder_names_no_program(tmp_path: Path, row: dict[str, Any]) -> None:
    results = tmp_path / "results"
    results.mkdir()
    (results / "evil.py").write_text(f"open({str(tmp_path / 'executed')!r}, 'w')\ndef run(sim): pass\nscene = run\n")
    evil = str(results / "evil.py")
    facts = {
        "axes": {}, "runs": 1, "seeds": [0], "arguments": [], "options": {}, "code": "",
        "scene": [evil, "", "scene"], "run": [evil, "", "run"],
    }  # fmt: skip
    (results / "study.json").write_text(json.dumps(facts | {"description": facts}))
    (results / "rows.jsonl").write_text(json.dumps(row) + "\n")
    (tmp_path / "mine.py").write_text(STUDY)
    for words in (["rerun", "results", "01"], ["rerun", "results", "01", "mine.py"]):
        outcome = _sweep(tmp_path, *words)
        assert "Traceback" not in outcome.stderr
        assert not (tmp_path / "executed").exists()


DAMAGE: dict[str, Any] = {
    "run": "ab/../../../precious", "error": 3, "recording": "javascript:alert(1)", "wall": "x", "ticks": None,
    "same": "yes", "seed": 1.5, "x": 10**400, "where": [],
}  # fmt: skip


@pytest.mark.parametrize("name", DAMAGE)
def test_a_row_that_is_none_is_left_out(name: str, tmp_path: Path, row: dict[str, Any]) -> None:
    (tmp_path / "rows.jsonl").write_text(json.dumps(row | {name: DAMAGE[name]}) + "\n")
    assert not read_rows(tmp_path)
    missing = {key: value for key, value in row.items() if key != name}
    (tmp_path / "rows.jsonl").write_text(json.dumps(missing) + "\n" + "[" * 100_000 + "\n" + json.dumps(row) + "\n")
    assert list(read_rows(tmp_path).values()) == [row]


@pytest.mark.parametrize("content", ["", "[", "[" * 100_000, "[]", '{"axes": 3, "runs": 1}', '{"axes": {}}', "\x00"])
def test_a_damaged_description_is_named(content: str, tmp_path: Path) -> None:
    (tmp_path / "study.json").write_text(content)
    with pytest.raises(ValueError, match=r"study\.json is damaged"):
        Table.read(tmp_path)


@pytest.mark.parametrize(
    "names", ["rows.jsonl", ".lock", "study.json study.json.new study.new summary.html summary.new"]
)
@pytest.mark.parametrize("kind", ["pipe", "link"])
def test_special_files_are_neither_waited_for_nor_followed(names: str, kind: str, tmp_path: Path) -> None:
    results, precious = tmp_path / "results", tmp_path / "precious"
    results.mkdir()
    precious.write_text("a line without an end")
    for name in names.split():
        if kind == "pipe":
            os.mkfifo(results / name)
        else:
            (results / name).symlink_to(precious)
    (tmp_path / "study.py").write_text(STUDY)
    outcome = _sweep(tmp_path, "study.py", "-o", "results", "--workers", "0")
    assert precious.read_text() == "a line without an end"
    assert "Traceback" not in outcome.stderr
    if outcome.returncode:
        assert f"{name}: it is a link or a special file" in outcome.stderr
    else:
        assert len(Table.read(results)) == 2


RESULTS: dict[str, Any] = {
    "large": 10**400, "immense": 10**5000, "surrogate": "\ud800", "error": ValueError("\ud800\x00<b>"),
    "numbers": [10**400], "loop": [],
}  # fmt: skip
RESULTS["loop"].append(RESULTS["loop"])


@pytest.mark.parametrize("name", RESULTS)
def test_any_result_leaves_a_row_and_a_summary(name: str, tmp_path: Path) -> None:
    table = _study(RESULTS[name]).run(tmp_path, workers=0)
    assert [bool(one["error"]) for one in table] == [name != "surrogate"] * 2
    assert Table.read(tmp_path).rows == table.rows
    assert (tmp_path / "summary.html").exists()
    table.to_csv(tmp_path / "table.csv")


FINITE = [[-1.7e308, 1.7e308], [0.0, 5e-324], [1e17, 1e17 + 16.0], [1e308, 1e308], [1.7e308, 1.6e308], [-1e305] * 3]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("values", FINITE)
def test_any_finite_numbers_are_plotted(values: list[float]) -> None:
    array = np.array(values)
    for picture in (histogram("x", array), scatter("a", "x", array, array[::-1])):
        assert picture.endswith("</svg>")
        assert not {"nan", "inf"} & set(picture.replace('"', ",").split(","))


def test_many_kinds_of_failures_are_summarized_in_a_moment(tmp_path: Path, row: dict[str, Any]) -> None:
    rows = [row | {"run": f"{k:012x}", "error": "Error: " + chr(0x4E00 + k)} for k in range(5000)]
    calls = 0

    def count(*_: Any) -> None:
        nonlocal calls
        calls += 1

    sys.setprofile(count)
    try:
        write_summary(Table(rows, tmp_path), 5000)
    finally:
        sys.setprofile(None)
    assert calls < 500_000
    assert "other errors" in (tmp_path / "summary.html").read_text()


def test_a_worker_that_is_stopped_does_not_hold_the_end(tmp_path: Path) -> None:
    def scene() -> None:
        from morse.builder import Environment, FakeRobot

        FakeRobot("robot")
        Environment("empty")

    def run(sim: Any) -> None:
        if sim.seed() == 0:
            (tmp_path / "pid").write_text(str(os.getpid()))
            os.kill(os.getpid(), signal.SIGSTOP)

    def tell(_: str) -> None:
        if (tmp_path / "pid").exists():
            raise KeyboardInterrupt

    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        Study(scene, run, seeds=2).run(tmp_path / "r", workers=1, progress=tell)
    assert time.monotonic() - begin < 60.0
    with Ledger(tmp_path / "r"):
        pass
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


def test_a_result_that_contains_itself_is_named() -> None:
    endless: list[Any] = []
    endless.append({"again": endless})
    with pytest.raises(ValueError, match="the result 'x' is nested too deeply, or contains itself"):
        plain(endless, "the result 'x'")
