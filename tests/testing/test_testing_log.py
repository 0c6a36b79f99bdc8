import threading
from pathlib import Path

import pytest

from morse.testing.follow import LogWatch, follow


def test_lines_are_followed_as_they_are_written(tmp_path: Path) -> None:
    path = tmp_path / "log"
    path.touch()
    ended = threading.Event()
    seen: list[str] = []
    with path.open() as reading, path.open("w") as writing:
        thread = threading.Thread(target=lambda: seen.extend(follow(reading, ended.is_set)))
        thread.start()
        for text in ("one\n", "tw", "o\nthr", "ee"):
            writing.write(text)
            writing.flush()
        ended.set()
        thread.join(60)
    assert seen == ["one\n", "two\n", "three"]


def watch(tmp_path: Path, text: str) -> tuple[LogWatch, list[str]]:
    path = tmp_path / "log"
    path.write_text(text)
    errors: list[str] = []
    made = LogWatch(path, lambda: True, errors.append)
    made.start()
    made.join(60)
    assert made.over
    return made, errors


def test_a_log_tells_the_process_the_port_and_the_start(tmp_path: Path) -> None:
    text = (
        "[    0.025] PID: 4711\n[    0.744] [socket.request_manager] services are on port 4003\n"
        "[SCENE INITIALIZED]\nPID: 1\n"
    )
    made, errors = watch(tmp_path, text)
    assert (made.pid, made.port, made.initialized, made.error) == (4711, 4003, True, None)
    assert errors == []
    assert made.excerpt().splitlines()[-1] == "    PID: 1"


@pytest.mark.parametrize("line", ["[ERROR][MORSE] no such robot", "INITIALIZATION ERROR: no port"])
def test_an_error_before_the_start_is_noted(tmp_path: Path, line: str) -> None:
    made, errors = watch(tmp_path, f"PID\n{line}\n[ERROR][MORSE] the next\n")
    assert (made.pid, made.error, made.initialized) == (None, line, False)
    assert errors == []


def test_an_error_while_it_runs_is_told(tmp_path: Path) -> None:
    _, errors = watch(tmp_path, "[SCENE INITIALIZED]\n[ERROR][MORSE] first\n[ERROR][MORSE] second\n")
    assert errors == ["[ERROR][MORSE] first"]


def test_an_empty_log(tmp_path: Path) -> None:
    made, _ = watch(tmp_path, "")
    assert "empty" in made.excerpt()
    assert not made.wait(lambda: made.initialized, 5)
