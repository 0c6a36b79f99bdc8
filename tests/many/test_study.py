"""Studies: rows, resumption, failures, and processes that are killed."""

import importlib.metadata
import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import morse
from morse.cli.sweep import ProgressLine
from morse.many import Study, Table, choice, loguniform, normal, uniform
from morse.many.executors import pack_size
from morse.many.results import read_rows
from morse.many.run import RunTimeout, limited
from tests.kit.programs import BESIDE, python
from tests.kit.waiting import wait_until

SCENE = """
import os, signal, pathlib
from morse.many import Study, uniform

def scene(start=0.0):
    from morse.builder import Environment, MotionVW, Pose, Robot
    robot = Robot(name="robot")
    robot.translate(start)
    pose = Pose("pose")
    pose.noise(gaussian=0.01)
    for part in (MotionVW("motion"), pose):
        robot.append(part)
    Environment("empty")
"""
STUDY = SCENE + '''
def run(sim, gain, speed):
    folder = pathlib.Path(os.environ["PIDS"])
    (folder / str(os.getpid())).touch()
    sim.robot.motion.publish({"v": gain * speed})
    sim.step(30)
    x = sim.robot.pose.data["x"]
    if gain > 1.0 and sim.seed() == 1:
        raise RuntimeError(f"crash at {x:.3f} m")
    return {"x": x}

study = Study(scene, run, start=[0.0, 1.0], gain=[0.8, 1.6], speed=uniform(0.2, 1.2, samples=2), seeds=3)
'''  # fmt: skip


@pytest.fixture
def pids(tmp_path, monkeypatch):
    folder = tmp_path / "pids"
    folder.mkdir()
    monkeypatch.setenv("PIDS", str(folder))
    return folder


def study_of(tmp_path, text=STUDY, name="study"):
    from morse.many.sources import imported

    file = tmp_path / f"{name}.py"
    file.write_text(text)
    return imported(str(file)).study


def test_rows_say_all_about_a_run(tmp_path, pids):
    study = study_of(tmp_path)
    table = study.run(tmp_path / "r", workers=2)
    assert len(study) == len(table) == 2 * 2 * 2 * 3
    assert len(table.failures) == 2 * 2
    row = next(row for row in table if not row["error"] and row["gain"] == 0.8)
    assert row["x"] == pytest.approx(row["start"] + 0.8 * row["speed"] * 0.5, abs=0.06)
    assert row["ticks"] == 30
    assert len(row["hash"]) == 64
    assert row["wall"] > 0.0
    assert row["cpu"] > 0.0
    assert "mujoco" in row["versions"]
    assert row["processor"]
    assert row["machine"]
    for row in table.failures:
        assert row["error"].startswith("RuntimeError: crash at")
        assert "study.py" in row["where"]
        assert row["same"] is True
        assert (tmp_path / "r" / row["recording"]).stat().st_size > 0
    assert "crash at" in (tmp_path / "r" / "summary.html").read_text()
    assert study.rerun(tmp_path / "r", table.failures[0]["run"][:8])["same"]
    with pytest.raises(LookupError, match=r"there is no run .xyz."):
        study.rerun(tmp_path / "r", "xyz")


def test_a_second_start_does_nothing_and_other_code_gets_other_names(tmp_path, pids):
    study = study_of(tmp_path)
    table = study.run(tmp_path / "r", workers=0)
    lines = (tmp_path / "r" / "rows.jsonl").read_bytes()
    assert study.run(tmp_path / "r", workers=0).rows == table.rows
    assert (tmp_path / "r" / "rows.jsonl").read_bytes() == lines
    other = study_of(tmp_path, STUDY + "\n# another version\n", "other")
    assert {run.name for run in other.runs()}.isdisjoint({row["run"] for row in table})


SLOW = """
import time
from morse.many import Study

def scene():
    from morse.builder import ATRV, Environment
    ATRV("robot")
    Environment("empty")

def run(sim):
    end = time.monotonic() + 0.6
    while time.monotonic() < end:
        sim.step()
    return {"x": 1.0}

study = Study(scene, run, seeds=2, timeout=0.3)
"""


@pytest.mark.parametrize("workers", [0, 1])
def test_a_timeout_that_is_longer_does_the_runs_again(tmp_path, caplog, workers):
    short = study_of(tmp_path, SLOW)
    long = Study(short.scene, short.run_function, seeds=2, timeout=60.0)
    assert len(short.run(tmp_path / "r", workers=workers).failures) == 2
    table = long.run(tmp_path / "r", workers=workers)
    assert table["x"] == [1.0, 1.0]
    assert not table.failures
    assert "contains 2 runs of another study (timeout: 0.3, now 60.0): they stay in rows.jsonl" in caplog.text
    assert Table.read(tmp_path / "r").rows == table.rows
    caplog.clear()
    assert long.run(tmp_path / "r", workers=workers).rows == table.rows
    assert not caplog.text


def test_a_folder_of_an_earlier_version_is_told(tmp_path, caplog):
    study = study_of(tmp_path, SLOW.replace("timeout=0.3", ""))
    study.run(tmp_path / "r", workers=0)
    facts = json.loads((tmp_path / "r" / "study.json").read_text())
    rows = [json.loads(line) for line in (tmp_path / "r" / "rows.jsonl").read_text().splitlines()]
    (tmp_path / "r" / "study.json").write_text(json.dumps(facts | {"identity": None, "code": "0"}))
    text = "".join(json.dumps(row | {"run": f"{number:012x}"}) + "\n" for number, row in enumerate(rows))
    (tmp_path / "r" / "rows.jsonl").write_text(text)
    assert len(Table.read(tmp_path / "r")) == 2
    study.run(tmp_path / "r", workers=0)
    assert "2 runs of another study (an earlier version of MORSE, which did not compare timeout" in caplog.text
    assert len(Table.read(tmp_path / "r")) == 2
    assert len((tmp_path / "r" / "rows.jsonl").read_text().splitlines()) == 4


def bare(size=1.0):
    from morse.builder import ATRV, Environment

    robot = ATRV("robot")
    robot.translate(size)
    Environment("empty")


def first(sim, gain=1):
    pass


def second(sim, gain=1):
    pass


def closure(value):
    def run(sim, gain=1):
        return value

    return run


class Called:
    def __init__(self, value):
        self.value = value

    def __call__(self, sim, gain=1):
        pass

    def method(self, sim, gain=1):
        pass


def cell(text):
    """A function of a notebook, which is in no file."""
    names = {"__name__": "__main__"}
    exec(compile(text, "<cell>", "exec"), names)
    return names["run"]


IDENTITIES = {
    "function": (Study(bare, first), Study(bare, second)),
    "scene": (Study(bare, first), Study(partial(bare, 2.0), first)),
    "partial": (Study(bare, partial(first, gain=1)), Study(bare, partial(first, gain=2))),
    "closure": (Study(bare, closure([1, 2.0])), Study(bare, closure([1, 3.0]))),
    "function in a closure": (Study(bare, closure(first)), Study(bare, closure(second))),
    "array in a closure": (Study(bare, closure(np.zeros(3))), Study(bare, closure(np.ones(3)))),
    "default": (Study(bare, lambda sim, k=1: k), Study(bare, lambda sim, k=2: k)),
    "lambda": (Study(bare, lambda sim: 1), Study(bare, lambda sim: 2)),
    "object": (Study(bare, Called(1)), Study(bare, Called(2))),
    "method": (Study(bare, Called(1).method), Study(bare, Called(1).__call__)),
    "object of a method": (Study(bare, Called(1).method), Study(bare, Called(2).method)),
    "timeout": (Study(bare, first, timeout=1), Study(bare, first, timeout=2)),
    "no timeout": (Study(bare, first), Study(bare, first, timeout=2)),
    "options": (Study(bare, first, options={"strict": True}), Study(bare, first)),
    "value of an option": (
        Study(bare, first, options={"on_failure": "raise"}), Study(bare, first, options={"on_failure": "deactivate"})
    ),
    "arguments": (Study(bare, first, arguments=["a"]), Study(bare, first, arguments=["b"])),
    "cell of a notebook": (Study(bare, cell("def run(sim): return 1")), Study(bare, cell("def run(sim): return 2"))),
    "helper in a notebook": (
        Study(bare, cell("def help(): return 1\ndef run(sim): return help()")),
        Study(bare, cell("def help(): return 2\ndef run(sim): return help()")),
    ),
    "number in a notebook": (
        Study(bare, cell("G = 1\ndef run(sim): return G")), Study(bare, cell("G = 2\ndef run(sim): return G"))
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", IDENTITIES)
def test_what_determines_a_run_belongs_to_its_name(what):
    one, other = IDENTITIES[what]
    assert {run.name for run in one.runs()}.isdisjoint(run.name for run in other.runs())


def test_the_versions_belong_to_the_name_of_a_run(monkeypatch):
    names = {Study(bare, first).one({}, 0).name}
    for module, version in (("mujoco-core", "9.9"), ("numpy", "9.9")):
        real = importlib.metadata.version
        with monkeypatch.context() as patch:
            patch.setattr("morse.many.run.version", lambda name: version if name == module else real(name))  # noqa: B023
            names.add(Study(bare, first).one({}, 0).name)
    monkeypatch.setattr("morse.many.run.__version__", "9.9")
    names.add(Study(bare, first).one({}, 0).name)
    assert len(names) == 4


def test_the_same_study_has_the_same_names_in_another_process(tmp_path):
    """Also of scenes that are data, and of values that the order of a set or an address could change."""
    text = """
import morse
from functools import partial
from morse.builder import ATRV, Environment
from morse.builder.script import build
from morse.many import Study

def scene(size=1.0):
    robot = ATRV("robot")
    robot.translate(size)
    Environment("empty")

def run(sim, *, names, what):
    pass

def closed(value):
    return lambda sim: value

class Thing:
    pass

for number in range(2):
    data = morse.load(partial(scene, 1.0 + number), sockets=False)
    described = data.context.scene
    data.close()
    for study in (
        Study(described, closed({"b", "a", "c", "d"})),
        Study(scene, partial(run, names={"x": 1, "y": 2}, what=Thing())),
    ):
        print(study.one({}, 0).name)
"""
    (tmp_path / "names.py").write_text(text.replace("from morse.builder.script import build\n", ""))
    outputs = [
        subprocess.run(
            [sys.executable, "names.py"], cwd=tmp_path, capture_output=True, text=True, timeout=120, check=True,
            env=os.environ | {"PYTHONHASHSEED": seed},
        ).stdout.split()
        for seed in ("1", "2")
    ]  # fmt: skip
    assert outputs[0] == outputs[1]
    assert len(set(outputs[0])) == 3  # the two scenes differ, the second study is the same


def test_all_executors_give_the_same_bits(tmp_path, pids):
    study = study_of(tmp_path)
    hashes = {row["run"]: row["hash"] for row in study.run(tmp_path / "inline", workers=0)}
    with ThreadPoolExecutor(2) as threads:
        assert {row["run"]: row["hash"] for row in study.run(tmp_path / "t", executor=threads)} == hashes
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn"), exec, (BESIDE,)) as processes:
        assert {row["run"]: row["hash"] for row in study.run(tmp_path / "p", executor=processes)} == hashes
    assert {row["run"]: row["hash"] for row in study.run(tmp_path / "local", workers=2)} == hashes


def test_functions_within_a_function_are_forked(tmp_path):
    def scene():
        from morse.builder import ATRV, Environment

        ATRV("robot")
        Environment("empty")

    def run(sim, factor):
        sim.step(factor)
        return sim.ticks

    table = Study(scene, run, factor=[1, 2, 3]).run(tmp_path / "r", workers=2)
    assert table["result"] == [1, 2, 3]


def test_runs_in_processes_that_are_no_copies(tmp_path, pids, monkeypatch):
    """As on systems without copies: programs of their own, also for a script without a main guard."""
    hashes = {row["run"]: row["hash"] for row in study_of(tmp_path).run(tmp_path / "inline", workers=0)}
    before = len(list(pids.iterdir()))
    monkeypatch.setattr("morse.many.executors.can_fork", lambda: False)
    table = study_of(tmp_path).run(tmp_path / "r", workers=2)
    assert {row["run"]: row["hash"] for row in table} == hashes
    assert len(list(pids.iterdir())) > before


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="limits of time need signals")
@pytest.mark.parametrize("place", ["__enter__", "__exit__"])
def test_a_limit_that_is_reached_at_the_border_of_a_tick_leaves_a_simulation_that_goes_on(place):
    """An error in the lines that take or release a tick would leave the simulation owned for ever."""
    reached = []

    def at_the_border():
        if not reached and sys._getframe(2).f_code.co_name == place:
            reached.append(place)
            signal.raise_signal(signal.SIGALRM)

    class Lock:
        def __init__(self):
            self._lock = threading.Lock()

        def acquire(self, **options):
            acquired = self._lock.acquire(**options)
            at_the_border()
            return acquired

        def release(self):
            at_the_border()
            self._lock.release()

    def scene():
        from morse.builder import Environment

        Environment("empty")

    def run_on(sim):
        while True:
            sim.step()

    with morse.load(scene) as sim:
        sim._time._lock = Lock()
        with pytest.raises(RunTimeout), limited(1000.0):
            run_on(sim)
        assert reached == [place]
        sim.step()


def test_closures_are_limited_in_time_print_and_start_processes(tmp_path):
    def scene():
        from morse.builder import ATRV, Environment

        ATRV("robot")
        Environment("empty")

    def run(sim, kind):
        print("is this an answer?", flush=True)
        os.write(1, b"\x00\xff\n" * 1000)
        while kind == "endless":
            sim.step()
        context = multiprocessing.get_context("fork")
        process = context.Process(target=time.sleep, args=(0,))
        process.start()
        process.join()
        return process.exitcode

    table = Study(scene, run, kind=["quick", "endless"], timeout=3.0).run(tmp_path / "r", workers=2)
    assert table["result"] == [0, None]
    assert "RunTimeout" in table[1]["error"]


@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="the process table is that of Linux")
def test_the_end_of_the_process_that_is_copied_is_named(tmp_path, pids):
    study = study_of(
        tmp_path,
        SCENE
        + """
def run(sim, number):
    stat = pathlib.Path(f"/proc/{os.getppid()}/cmdline").read_bytes()
    assert b"morse.many.forking" in stat
    os.kill(os.getppid(), signal.SIGKILL)
    os.kill(os.getpid(), signal.SIGKILL)

study = Study(scene, run, number=range(3))
""",
    )
    with pytest.raises(RuntimeError, match=r"the process that starts the workers has ended.*start the study again"):
        study.run(tmp_path / "r", workers=1)


def test_an_interruption_of_a_sweep_loses_nothing_that_is_done(tmp_path, pids):
    """A signal at any moment: rows that were taken stay, and the same call goes on."""

    class Alarm(Exception):
        pass

    def ring(*_):
        raise Alarm

    # some runs do not end before the third interruption, however fast the machine is
    gate = tmp_path / "gate"
    wait = f"    while sim.seed() == 2 and not os.path.exists({str(gate)!r}):\n        time.sleep(0.01)\n"
    text = STUDY.replace("    sim.step(30)\n", wait + "    sim.step(30)\n").replace("import os", "import os, time", 1)
    assert wait in text
    study, rounds = study_of(tmp_path, text), 0
    before = signal.signal(signal.SIGALRM, ring)
    try:
        while len(read_rows(tmp_path / "r")) < len(study) and rounds < 60:
            rounds += 1
            try:
                signal.setitimer(signal.ITIMER_REAL, 0.3 + 0.15 * rounds)
                table = study.run(tmp_path / "r", workers=2)
                signal.setitimer(signal.ITIMER_REAL, 0.0)
            except Alarm:
                if rounds == 3:
                    gate.touch()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    assert rounds > 3
    table = study.run(tmp_path / "r", workers=2)
    hashes = {row["run"]: row["hash"] for row in study.run(tmp_path / "inline", workers=0)}
    assert {row["run"]: row["hash"] for row in table} == hashes
    for pid in [int(file.name) for file in pids.iterdir() if int(file.name) != os.getpid()]:
        wait_until(lambda: not alive(pid), "end of a worker")  # noqa: B023


@pytest.mark.parametrize("workers", [0, 1])
def test_a_function_that_ends_the_program_is_a_failed_run(tmp_path, workers):
    text = (
        SCENE
        + """
def run(sim, number):
    if number == 1:
        raise SystemExit("enough")
    return {"value": number}

study = Study(scene, run, number=range(3))
"""
    )
    table = study_of(tmp_path, text).run(tmp_path / "r", workers=workers)
    assert table["value"] == [0, None, 2]
    assert table[1]["error"] == "SystemExit: enough"


def test_a_killed_worker_loses_nothing(tmp_path, pids):
    text = (
        SCENE
        + """
def run(sim, number):
    marker = pathlib.Path(os.environ["PIDS"]) / f"run{number}"
    sim.step(5)
    if number == 2 or (number == 1 and not marker.exists()):
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"value": number}

study = Study(scene, run, number=range(4))
"""
    )
    table = study_of(tmp_path, text).run(tmp_path / "r", workers=2)
    assert table["value"] == [0, 1, None, 3]
    assert table[2]["error"] == "its process died 3 times"
    assert Counter(row["run"] for row in table).most_common(1)[0][1] == 1


def alive(pid):
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{pid}/stat")
    return not state.exists() or state.read_text().rpartition(")")[2].split()[0] != "Z"


def test_a_killed_driver_loses_nothing_and_leaves_no_orphans(tmp_path, pids):
    study = study_of(tmp_path)
    command = [
        sys.executable,
        "-m",
        "morse",
        "sweep",
        str(tmp_path / "study.py"),
        "-o",
        str(tmp_path / "r"),
        "--workers",
        "2",
    ]
    driver = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    rows = tmp_path / "r" / "rows.jsonl"
    try:
        wait_until(lambda: rows.exists() and rows.read_bytes().count(b"\n") >= 3, "third row")
    finally:
        driver.send_signal(signal.SIGKILL)
        driver.wait()
    workers = [int(file.name) for file in pids.iterdir()]
    assert workers
    wait_until(lambda: not any(map(alive, workers)), "end of the workers")
    with open(rows, "ab") as file:
        file.write(b'{"run": "half')  # as if it had died while it wrote
    before = {row["run"]: row for row in map(json.loads, rows.read_bytes().splitlines()[:3])}
    table = study.run(tmp_path / "r", workers=2)
    assert len(table) == len(study)
    assert len({row["run"] for row in table}) == len(study)
    kept = {row["run"]: row for row in table}
    assert all(kept[name]["wall"] == row["wall"] for name, row in before.items())
    other = study.run(tmp_path / "other", workers=0)
    assert {row["run"]: row["hash"] for row in table} == {row["run"]: row["hash"] for row in other}


def test_one_process_at_a_time_has_a_folder(tmp_path, pids):
    from morse.many.results import Ledger

    with Ledger(tmp_path / "r"), pytest.raises(RuntimeError, match="another process is running a study"):
        study_of(tmp_path).run(tmp_path / "r", workers=0)


def test_twenty_failures_of_each_kind_are_recorded(tmp_path):
    text = (
        SCENE
        + """
def run(sim, number):
    assert number % 25 == 0, f"failed with {number}"
study = Study(scene, run, number=range(25))
"""
    )
    table = study_of(tmp_path, text).run(tmp_path / "r", workers=0)
    assert len(table.failures) == 24
    assert sum(bool(row["recording"]) for row in table) == 20
    assert "there is another result" not in str(table)


@pytest.mark.parametrize("workers", [0, 2])
def test_a_run_without_an_end_fails(tmp_path, workers):
    text = (
        SCENE
        + """
def run(sim, kind):
    while kind:
        try:
            sim.step() if kind == "step" else sum(range(1000))
        except Exception:
            pass
    sim.step(3)
    return {"x": 1.0}
study = Study(scene, run, kind=["", "step", "python"], timeout=3.0)
"""
    )
    table = study_of(tmp_path, text).run(tmp_path / "r", workers=workers)
    rows = {row["kind"]: row for row in table}
    assert (rows[""]["error"], rows[""]["x"], rows[""]["ticks"]) == ("", 1.0, 3)
    for kind in ("step", "python"):
        assert rows[kind]["error"] == "RunTimeout: the run has taken longer than 3 s of wall-clock time"
        assert rows[kind]["hash"] == ""
        assert rows[kind]["wall"] >= 3.0
    assert rows["step"]["ticks"] > 0


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda run: Study("s.py", run, gian=[1]), "no one uses the parameter 'gian'; did you mean 'gain'"),
        (lambda run: Study("s.py", run, gain=[]), "'gain' has no values"),
        (lambda run: Study("s.py", run, gain=[object()]), "'gain' is a object"),
        (lambda run: Study("s.py", run, ticks=[1]), "cannot be called 'ticks'"),
        (lambda run: Study("s.py", run, timeout=-1.0), "timeout is a time in seconds"),
        (lambda run: uniform(2.0, 1.0), "the lower one first"),
        (lambda run: uniform(0.0, 1.0, samples=0), "at least 1"),
        (lambda run: loguniform(0.0, 1.0), "greater than 0"),
        (lambda run: normal(0.0, -1.0), "not negative"),
        (lambda run: choice(), "no value"),
        (lambda run: Table.read("nowhere"), "contains no results"),
    ],
)
def test_mistakes_are_named(make, message):
    def run(sim, gain):
        pass

    with pytest.raises((TypeError, ValueError, FileNotFoundError), match=message):
        make(run)


def test_distributions_draw_the_same_each_time():
    assert uniform(0.0, 1.0, samples=5).values("a") == uniform(0.0, 1.0, samples=5).values("a")
    assert uniform(0.0, 1.0, samples=5).values("a") != uniform(0.0, 1.0, samples=5).values("b")
    values = loguniform(0.01, 100.0, samples=2000).values("a")
    assert sum(value < 1.0 for value in values) == pytest.approx(1000, abs=100)
    assert set(choice("x", "y", samples=50).values("c")) == {"x", "y"}


def test_results_that_are_no_plain_data_fail_the_run(tmp_path):
    text = (
        SCENE
        + """
def run(sim, kind):
    return {"object": {"bad": object()}, "name": {"hash": 1}, "good": 3}[kind]
study = Study(scene, run, kind=["object", "name", "good"])
"""
    )
    table = study_of(tmp_path, text).run(tmp_path / "r", workers=0)
    assert "the result 'bad' is a object" in table[0]["error"]
    assert "a result cannot be called 'hash'" in table[1]["error"]
    assert table[2]["result"] == 3
    assert table.to_dict()["kind"] == ["object", "name", "good"]


def test_a_line_of_progress_is_printed_once_where_lines_stay(capsys):
    show = ProgressLine()
    for line in ("0 of 2", "0 of 2", "1 of 2", "1 of 2", "2 of 2"):
        show(line)
    assert capsys.readouterr().err.splitlines() == ["0 of 2", "1 of 2", "2 of 2"]


def test_the_command(tmp_path, pids):
    (tmp_path / "study.py").write_text(STUDY)

    def morse(*words):
        command = [sys.executable, "-m", "morse", "sweep", *words]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=240)

    first = morse("study.py", "-o", "r", "--workers", "2")
    assert first.returncode == 3, first.stderr
    assert "24 runs in r, 4 failed" in first.stdout
    again = morse("study.py", "-o", "r", "--keep-going")
    assert again.returncode == 0
    assert "24 of 24 runs are done, 4 failed" in again.stderr
    failed = Table.read(tmp_path / "r").failures[0]["run"]
    rerun = morse("rerun", "r", failed[:6], "study.py")
    assert "the same, bit for bit" in rerun.stdout, rerun.stderr
    watch = morse("watch", "r")
    assert "24 of 24" in watch.stderr
    assert watch.returncode == 3
    for words, message in [
        (("nothing.py",), "no file nothing.py"),
        (("rerun", "r", "xyz"), "morse sweep rerun FOLDER RUN STUDY.py"),
        (("rerun", "r", "xyz", "study.py"), "there is no run 'xyz'"),
        (("watch", "nowhere"), "contains no results"),
    ]:
        outcome = morse(*words)
        assert outcome.returncode != 0
        assert message in outcome.stdout + outcome.stderr
        assert "Traceback" not in outcome.stderr


FRAIL = """
from morse.core.sensor import Sensor
from morse.helpers.components import add_data

class Frail(Sensor):
    add_data("count", 0, "int", "Number of measurements")
    def default_action(self):
        self.local_data["count"] += 1
        if self.local_data["count"] > 3 and self.context.seed == 1:
            raise ValueError("too frail")
    def finalize(self):
        super().finalize()
        if self.context.seed == 2:
            raise OSError("no end")
"""
HIDES = """
from frail import Frail
from morse.many import Study

def scene():
    from morse.builder import ATRV, Environment
    robot = ATRV("robot")
    robot.append(Frail("frail"))
    off = ATRV("off")
    off.translate(21, 0, 0.1)
    Environment("empty", fastmode=True)

def run(sim):
    try:
        for _ in range(120):
            sim.step()
    except ValueError:
        pass
    return sim.ticks

study = Study(scene, run, seeds=3{options})
"""


@pytest.mark.parametrize("options", ["", ', options={"on_failure": "deactivate"}'])
def test_a_run_with_a_part_that_fails_has_failed(tmp_path, monkeypatch, options):
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "frail.py").write_text(FRAIL)
    table = study_of(tmp_path, HIDES.format(options=options), f"hides{len(options)}").run(tmp_path / "r", workers=0)
    rows = {row["seed"]: row for row in table}
    if options:
        assert [row["error"] for row in table] == ["", "", ""], "the study wants it so"
    else:
        assert [row["error"] for row in rows.values()] == [
            "", "robot.frail is deactivated: ValueError: too frail", "OSError: no end"
        ]  # fmt: skip
        line = next(number for number, text in enumerate(FRAIL.splitlines(), 1) if "too frail" in text)
        assert rows[1]["where"].endswith(f"frail.py:{line}")
        assert "frail.py" in rows[2]["where"]
    assert [row["left_world"] for row in rows.values()] == ["off", "off" if options else "", "off"]


def test_a_script_without_a_main_guard(tmp_path):
    text = (
        SCENE
        + """
def run(sim):
    sim.step(3)
    return sim.ticks
study = Study(scene, run, seeds=3)
print(len(study.run("r", workers=2)), "rows")
"""
    )
    (tmp_path / "script.py").write_text(text)
    outcome = python("script.py", folder=tmp_path)
    assert outcome.stdout.split("\n")[0] == "3 rows", outcome.stderr


@pytest.mark.slow
def test_ray_gives_the_same_bits(tmp_path, pids):
    import importlib.util

    if importlib.util.find_spec("ray") is None:
        return  # of 260 MB, which MORSE does not install
    from morse.many.rays import RayExecutor

    study = study_of(tmp_path)
    executor = RayExecutor("local", 2)
    try:
        table = study.run(tmp_path / "ray", executor=executor)
    finally:
        executor.shutdown()
    hashes = {row["run"]: row["hash"] for row in study.run(tmp_path / "inline", workers=0)}
    assert {row["run"]: row["hash"] for row in table} == hashes


@pytest.mark.slow
def test_a_killed_node_of_ray_loses_nothing(tmp_path, pids):
    import importlib.util

    if importlib.util.find_spec("ray") is None:
        return
    import ray
    from ray.cluster_utils import Cluster

    from morse.many.rays import RayExecutor

    # each takes a while, and none fails: failures are done twice, with a recording
    text = STUDY.replace("import os,", "import os, time,").replace("gain=[0.8, 1.6]", "gain=[0.4, 0.8]")
    text = text.replace("    sim.step(30)\n", "    time.sleep(0.5)\n    sim.step(30)\n")
    study = study_of(tmp_path, text)
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    try:
        doomed = cluster.add_node(num_cpus=1)
        ray.init(address=cluster.address, log_to_driver=False, logging_level="ERROR")
        cluster.wait_for_nodes()
        executor = RayExecutor("auto")
        with ThreadPoolExecutor(1) as thread:
            future = thread.submit(study.run, tmp_path / "ray", executor=executor)
            limit = time.monotonic() + 120.0
            while len(list(pids.iterdir())) < 2 and time.monotonic() < limit:  # both nodes work
                time.sleep(0.1)
            assert not future.done()
            cluster.remove_node(doomed, allow_graceful=False)
            table = future.result(timeout=300)
    finally:
        ray.shutdown()
        cluster.shutdown()
    names = Counter(json.loads(line)["run"] for line in (tmp_path / "ray" / "rows.jsonl").read_text().splitlines())
    assert set(names.values()) == {1}
    hashes = {row["run"]: row["hash"] for row in study.run(tmp_path / "inline", workers=0)}
    assert {row["run"]: row["hash"] for row in table} == hashes


@pytest.mark.parametrize("workers", [1, 8, 64_000])
@pytest.mark.parametrize("time", [1e-4, 0.2, 20.0, 3000.0])
def test_packs_are_small_at_the_end_but_not_too_small_for_the_driver(workers, time):
    for remaining in (1, workers, 10 * workers, 10_000 * workers):
        size = pack_size(remaining, workers, time)
        # no worker waits for a run that is in the pack of another one
        assert 1 <= size <= min(500, remaining // workers + 1)
        # a call of Ray takes 1.25 ms: the driver gives a pack to each worker in the time that one takes
        handing_out = 1.25e-3 * workers
        if size < min(500, remaining // workers + 1):
            assert (size + 1) * max(time, 1e-3) >= handing_out
        # twenty seconds of work, or as long as handing out takes
        assert size == 1 or size * max(time, 1e-3) <= max(20.0, handing_out)


def test_a_session_does_the_runs_that_a_program_chooses(tmp_path, pids):
    study = study_of(tmp_path)
    with study.open(tmp_path / "r", workers=2) as session:
        begun = [{"start": 0.0, "gain": 0.8, "speed": speed} for speed in (0.1, 0.4, 0.9)]
        for parameters in begun:
            assert session.submit(parameters, 3) is None
        assert session.submit(begun[0], 3) is None, "it is under way: once is enough"
        rows = []
        while session.is_busy:
            rows += session.results()
        assert sorted(row["speed"] for row in rows) == [0.1, 0.4, 0.9]
        assert session.has_room
        known = session.submit(begun[0], 3)
        assert known in rows
        assert session.submit(begun[0], 3, record=True) is None
        while session.is_busy:
            recorded = session.results()
        assert recorded[0]["same"] is True
        assert (tmp_path / "r" / recorded[0]["recording"]).stat().st_size > 0
        with pytest.raises(TypeError, match="the parameters are start, gain, speed, not gain"):
            session.submit({"gain": 1.0})
        with pytest.raises(LookupError, match="has not been done yet"):
            session.submit(begun[0], 4, record=True)
        with pytest.raises(RuntimeError, match="another process is running a study"):
            study.open(tmp_path / "r")
    with study.open(tmp_path / "r", workers=0) as session:
        assert len(session.rows) == 3
        assert session.submit(begun[1], 3)["speed"] == 0.4
        assert session.submit({"start": 0.0, "gain": 1.6, "speed": 0.5}, 1) is None
        (failed,) = session.results()
        assert failed["error"].startswith("RuntimeError: crash at")
        assert not failed["recording"]


def test_a_script_that_opens_a_session_itself_is_a_study_for_its_workers(tmp_path, pids):
    text = STUDY + (
        '\nwith study.open("r", workers=1) as session:\n'
        '    session.submit({"start": 0.0, "gain": 0.8, "speed": 0.3})\n'
        "    (row,) = session.results(60)\n"
        '    print(row["error"], row["ticks"])\n'
    )
    (tmp_path / "own.py").write_text(text)
    done = python("own.py", folder=tmp_path)
    assert (done.stdout, done.stderr) == (" 30\n", "")
