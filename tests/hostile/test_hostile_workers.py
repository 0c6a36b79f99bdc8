"""A process that renders images may answer anything: it is replaced, and what it has sent is not taken for an image."""

import contextlib
import multiprocessing
import os
import pickle
import struct
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import morse
from morse.many import Study
from morse.rendering import workers
from morse.system.workers import Worker, WorkerError

SCENE = """
from morse.builder import *
robot = FakeRobot("robot")
camera = VideoCamera("camera")
camera.properties(cam_width=16, cam_height=12)
robot.append(camera)
env = Environment("empty")
"""
ANSWERS = {
    "empty": b"",
    "text": b"Segmentation fault\n",
    "half": pickle.dumps([1.0] * 100)[:50],
    "class_of_nobody": b"cnobody_has_this\nthing\n.",
    "huge": b"\x80\x05\x8e" + struct.pack("<Q", 1 << 60),
    "number": pickle.dumps(7),
    "list": pickle.dumps([]),
}


class Liar(Worker):
    """A worker that gives one wrong answer, then works."""

    wrong: list[bytes | BaseException]

    def ask(self, question: bytes, patience: float | None = None) -> bytes:
        """See `Worker`."""
        answer = super().ask(question, patience)
        if not self.wrong:
            return answer
        wrong = self.wrong.pop()
        if isinstance(wrong, BaseException):
            raise wrong
        return wrong


@pytest.mark.parametrize("answer", [*ANSWERS.values(), MemoryError("out of memory")], ids=[*ANSWERS, "memory"])
def test_a_worker_that_answers_wrong_bytes_is_replaced(
    answer: bytes | BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "scene.py"
    path.write_text(SCENE)
    monkeypatch.setattr(Liar, "wrong", [answer], raising=False)
    monkeypatch.setattr(workers, "Worker", Liar)
    with morse.load(path, cameras_on=1) as simulation:
        simulation.step(10)
        image = np.asarray(simulation.robot.camera.get()["image"])
    assert "another one replaces it" in caplog.text
    assert "deactivated" not in caplog.text
    assert image.size == 16 * 12 * 4


@pytest.mark.parametrize(
    "written", [b"Segmentation fault\n" * 3, struct.pack("!iQ", -1, 1 << 60), struct.pack("!i", 3) + b"abc"]
)
def test_what_is_written_into_the_connection_itself_is_no_answer(written: bytes) -> None:
    ours, theirs = multiprocessing.Pipe()
    worker = Worker(ours, None)
    os.write(theirs.fileno(), written)
    theirs.close()
    with pytest.raises(WorkerError):
        worker.receive()
    worker.close()


@pytest.mark.parametrize("written", [b"Segmentation fault\n", b"    at 0x7f", b"~~~~~"])
def test_nobody_waits_for_the_rest_of_what_is_no_message(written: bytes) -> None:
    """The process lives on, and believes that it has answered."""
    ours, theirs = multiprocessing.Pipe()
    worker = Worker(ours, None)
    # without a limit, this ends the test
    limit = threading.Timer(20.0, theirs.close)
    limit.start()
    os.write(theirs.fileno(), written)
    theirs.send_bytes(struct.pack("<Q", 0) + b"answer")
    with pytest.raises(WorkerError):
        worker.receive()
    assert limit.is_alive()
    limit.cancel()
    worker.close()
    theirs.close()


def scribble(sim: Any) -> None:
    """Write to every descriptor, as a library that logs to the number of a closed file."""
    sim.step()
    for number in range(3, 64):
        with contextlib.suppress(OSError):
            os.write(number, b"warning: something is wrong\n")


def close_all(sim: Any) -> None:
    """Close every descriptor, as a program does that becomes a daemon."""
    sim.step()
    os.closerange(3, 64)


@pytest.mark.parametrize("run", [scribble, close_all])
def test_a_run_that_uses_the_descriptors_of_others_is_a_failure(run: Callable[[Any], None], tmp_path: Path) -> None:
    (tmp_path / "scene.py").write_text(SCENE)
    (row,) = Study(tmp_path / "scene.py", run).run(tmp_path / "results", workers=1)
    assert row["error"]


def test_what_a_program_prints_before_it_serves_is_no_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python itself executes files of the user when it starts."""
    (tmp_path / "sitecustomize.py").write_text("import os; os.write(1, b'I am started\\n' * 1000)")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path), prepend=os.pathsep)
    (tmp_path / "scene.py").write_text(SCENE)
    with morse.load(tmp_path / "scene.py", cameras_on=1) as simulation:
        simulation.step(10)
        assert np.asarray(simulation.robot.camera.get()["image"]).size == 16 * 12 * 4
