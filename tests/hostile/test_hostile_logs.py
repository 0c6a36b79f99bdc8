"""Lines that repeat are counted, and every count is told."""

import logging
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from morse.assets.loader import load
from morse.core.clients.complaints import Complaints
from morse.core.reports.log import Folding, MorseFormatter


class Lines(logging.Handler):
    """Collects lines."""

    def __init__(self) -> None:
        super().__init__()
        self.lines: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.lines.append(record.getMessage())


@pytest.fixture
def logger() -> Iterator[logging.Logger]:
    logger = logging.getLogger("morse.test.hostile")
    logger.propagate = False
    yield logger
    logger.handlers.clear()
    logger.propagate = True


def _count(lines: list[str]) -> int:
    """The number of lines that were logged, as a reader of the log can tell it."""
    repeated = [re.search(r"(\d+) (?:times in|more of|warnings of)", line) for line in lines]
    return len([found for found in repeated if not found]) + sum(int(found[1]) for found in repeated if found)


def test_lines_that_differ_in_numbers_only_are_counted(logger: logging.Logger) -> None:
    handler, now = Lines(), [0.0]
    folding = Folding(handler, lambda: now[0])
    logger.addHandler(handler)
    for number in range(412):
        now[0] += 0.01
        logger.warning("127.0.0.1:%d cannot be accepted: [Errno %d] at 0x%x", 40000 + number, number, number)
    assert len(handler.lines) < 20
    logger.warning("another line")
    assert handler.lines[-1] == "another line"
    now[0] = 11.0
    assert not folding.tell(now=False)
    assert len(handler.lines) < 20
    assert _count(handler.lines) == 412 + 1
    logger.warning("127.0.0.1:1 cannot be accepted: [Errno 2] at 0x3")
    assert handler.lines[-1].endswith("0x3")


def test_a_line_in_each_tick_is_written(logger: logging.Logger) -> None:
    handler, now = Lines(), [0.0]
    Folding(handler, lambda: now[0])
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    for tick in range(1200):
        now[0] += 1 / 60
        logger.info("x = %f", tick)
    assert len(handler.lines) == 1200


def test_many_different_lines_need_little_memory(logger: logging.Logger) -> None:
    handler = Lines()
    folding = Folding(handler, lambda: 0.0)
    logger.addHandler(handler)
    letters = str.maketrans("0123456789", "abcdefghij")
    for number in range(3000):
        logger.warning("%s has failed", str(number).translate(letters))
    assert len(folding._kinds) < 300
    assert len(handler.lines) < 300
    folding.tell(now=True)
    assert _count(handler.lines) == 3000


def test_complaints_tell_their_counts_though_nothing_more_happens(logger: logging.Logger) -> None:
    handler, now = Lines(), [0.0]
    logger.addHandler(handler)
    complaints = Complaints(logger, lambda: now[0])
    for _ in range(50):
        complaints.warn("kind", "a client is wrong")
    for number in range(40):
        complaints.warn(f"kind {number}", "another client is wrong")
    before = len(handler.lines)
    assert complaints.tell(now=False)
    assert len(handler.lines) == before
    now[0] = 10.5
    assert not complaints.tell(now=False)
    assert _count(handler.lines) == 90


def test_a_text_of_megabytes_is_cut_with_its_length() -> None:
    text = "x" * 50_000_000
    record = logging.LogRecord("morse", logging.ERROR, __file__, 1, "%s", (text,), None)
    line = MorseFormatter().format(record)
    assert len(line) < 100_000
    assert "50000000" in line
    try:
        raise ValueError(text)
    except ValueError:
        record = logging.LogRecord("morse", logging.ERROR, __file__, 1, "failed", None, sys.exc_info())
    line = MorseFormatter().format(record)
    assert len(line) < 100_000
    assert re.search(r"\(5000\d{4} characters\)", line)


def test_asyncio_floods_are_folded_and_told_at_the_end_of_the_process() -> None:
    program = """
import logging
from morse.core.reports import log
log.setup()
for number in range(1000):
    logging.getLogger("asyncio").error("socket.accept() out of system resource %d", number)
    logging.getLogger("websockets.server").error("opening handshake failed %d", number)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    lines = (done.stdout + done.stderr).splitlines()
    assert len(lines) < 30
    assert _count(lines) == 2000


def test_a_file_with_many_mistakes_fills_no_log(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = tmp_path / "many.sdf"
    path.write_text('<sdf version="1.7"><model name="m">' + '<link name="a"/>' * 500 + "</model></sdf>")
    load(path)
    assert len(caplog.messages) <= 101
    assert caplog.messages[-1] == f"many.sdf: {len(load(path).warnings) - 100} more warnings of this file"
