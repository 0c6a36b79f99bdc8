"""Reliable readers of images: they get all that was sent, and none harms the others."""

import signal
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from other_side import DOMAIN, PYTHON, SETTINGS, environment, need

from morse.rosmsgs.table import Qos
from tests.kit.waiting import wait_until

PERIOD, LIMIT = 1 / 30, 60.0
SIZE = 640 * 480 * 3
TYPE = "sensor_msgs/msg/Image"


class Reader:
    def __init__(self, file: Path) -> None:
        self._file = file
        command = [PYTHON, str(Path(__file__).parent / "image_peer.py"), str(DOMAIN)]
        with file.open("w") as said:
            self.process = subprocess.Popen(command, stdout=said, stderr=said, env=environment(PYTHON))

    def images(self) -> list[int]:
        lines = [line.split() for line in self._file.read_text().splitlines() if line[:1].isdigit()]
        assert all(int(size) == SIZE for _, size in lines[:-1])
        return [int(number) for number, *_ in lines]


@pytest.fixture
def backend(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    need("cyclonedds")
    need("rclpy", PYTHON)
    for name in SETTINGS:
        monkeypatch.delenv(name, raising=False)
    from morse.middleware.ros2.backends.cyclone import CycloneBackend

    made = CycloneBackend({"domain_id": DOMAIN, "interface": "lo"})
    yield made
    made.close()


def send(backend: Any, publisher: Any, numbers: range) -> set[int]:
    """Send images at 30 Hz; returns the numbers of those that were sent."""
    sent = set()
    for number in numbers:
        message = {"header": {"stamp": {"sec": number}}, "height": 480, "width": 640, "encoding": "rgb8", "step": 1920}
        if publisher.publish(backend.encode(TYPE, {**message, "data": bytes(SIZE)})):
            sent.add(number)
        time.sleep(PERIOD)
    return sent


def reach(backend: Any, publisher: Any, readers: list[Reader]) -> bool:
    """Send images until all readers get them.

    Fast DDS 2.14 also keeps a part of an image for ever that was on its way when the reader was found.
    """
    matched = publisher._writer.get_publication_matched_status
    assert wait_until(lambda: matched().current_count == len(readers))
    end = time.monotonic() + LIMIT
    while not all(reader.images() for reader in readers) and time.monotonic() < end:
        send(backend, publisher, range(1))
    return all(reader.images() for reader in readers)


@pytest.mark.peer("ros-jazzy-rclpy")
def test_a_reader_gets_every_image_that_was_sent(backend: Any, tmp_path: Path) -> None:
    publisher = backend.publisher("/eye/image", TYPE, Qos())
    reader = Reader(tmp_path / "said")
    try:
        assert reach(backend, publisher, [reader])
        sent = send(backend, publisher, range(1, 61))
        assert len(sent) > 10
        assert wait_until(lambda: sent <= set(reader.images())), sorted(sent - set(reader.images()))
    finally:
        reader.process.kill()
        reader.process.wait()


class Unheard:
    """Stands for a writer with a reader that acknowledges nothing."""

    def __init__(self) -> None:
        self.written = 0

    def write(self, sample: Any) -> None:
        self.written += 1

    def wait_for_acks(self, seconds: int) -> bool:
        return False


def test_an_image_is_kept_for_a_second_for_those_who_have_a_part_of_it(
    backend: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    from cyclonedds.qos import Policy

    publisher = backend.publisher("/eye/image", TYPE, Qos())
    kept = publisher._writer.get_qos()[Policy.History].depth
    now, times = 0.0, []
    monkeypatch.setattr("morse.middleware.ros2.backends.cyclone.monotonic", lambda: now)
    publisher._writer = Unheard()
    for tick in range(600):  # 10 s
        now = tick / 60.0
        if publisher.publish(bytes(SIZE)):
            times.append(now)
    assert len(times) == publisher._writer.written
    # the one that leaves the history as another comes
    assert min(new - old for old, new in zip(times, times[kept:], strict=False)) >= 1.0 - 1e-9
    assert len(times) >= 30 * 9, "30 images a second go on"


@pytest.mark.slow
@pytest.mark.peer("ros-jazzy-rclpy")
def test_a_reader_that_does_not_answer_does_not_stop_the_others(backend: Any, tmp_path: Path) -> None:
    publisher = backend.publisher("/eye/image", TYPE, Qos())
    readers = [Reader(tmp_path / "one"), Reader(tmp_path / "other")]
    try:
        assert reach(backend, publisher, readers)
        readers[0].process.send_signal(signal.SIGSTOP)
        sent = send(backend, publisher, range(1, 121))
        assert max(sent) > 100, "images are sent again after a second"
        assert wait_until(lambda: max(readers[1].images()) > 100)
    finally:
        for reader in readers:
            reader.process.kill()
            reader.process.wait()
