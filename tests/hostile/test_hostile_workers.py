"""A process that renders images may answer anything: it is replaced, and what it has sent is not taken for an image."""

from __future__ import annotations

import pickle
import struct
from io import BytesIO
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import morse
from morse.rendering.workers import crew
from morse.system.worker_process import WorkerProcess, receive

if TYPE_CHECKING:
    from pathlib import Path

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


class Liar:
    """A worker that gives one wrong answer, then works."""

    wrong: list[bytes | BaseException]

    def __init__(self, *program: Any) -> None:
        self._worker = WorkerProcess(*program)

    def ask(self, message: bytes) -> bytes | bytearray:
        """See `Worker`."""
        answer = self._worker.ask(message)
        if not self.wrong:
            return answer
        wrong = self.wrong.pop()
        if isinstance(wrong, BaseException):
            raise wrong
        return wrong

    def close(self) -> None:
        """See `Worker`."""
        self._worker.close()


@pytest.mark.parametrize("answer", [*ANSWERS.values(), MemoryError("out of memory")], ids=[*ANSWERS, "memory"])
def test_a_worker_that_answers_wrong_bytes_is_replaced(
    answer: bytes | BaseException, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "scene.py"
    path.write_text(SCENE)
    monkeypatch.setattr(Liar, "wrong", [answer], raising=False)
    monkeypatch.setattr(crew, "WorkerProcess", Liar)
    with morse.load(path, cameras_on=1) as simulation:
        simulation.step(10)
        image = np.asarray(simulation.robot.camera.get()["image"])
    assert "another one replaces it" in caplog.text
    assert "deactivated" not in caplog.text
    assert image.size == 16 * 12 * 4


def test_a_length_that_is_text_allocates_nothing() -> None:
    with pytest.raises(EOFError, match="announced"):
        receive(BytesIO(b"Segmentation fault\n"))
