"""The format of the simulator's log, which other programs read."""

import io
import logging
import os
import re
import subprocess
import sys
from pathlib import Path

import pexpect
import pytest

import morse
from morse.core.reports import log
from morse.core.reports.log import ENDSECTION, SECTION, MorseFormatter

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(Path(morse.__file__).parents[1])}


def record(text, level=logging.INFO, name="morse", seconds=0.2834, *args, error=None):
    made = logging.LogRecord(name, level, __file__, 1, text, args, error)
    made.relativeCreated = seconds * 1000.0
    return made


@pytest.fixture(autouse=True)
def untouched_logging():
    root = logging.getLogger("morse")
    before = root.level, root.propagate, list(root.handlers)
    yield
    root.level, root.propagate, root.handlers[:] = before


@pytest.mark.parametrize(
    ("seconds", "line"),
    [(0.2834, "[    0.283] hello"), (12345.6789, "[12345.679] hello"), (1234567.0, "[1234567.000] hello")],
)
def test_time_stamp_has_nine_places(seconds, line):
    assert MorseFormatter().format(record("hello", seconds=seconds)) == line


def test_line_of_the_summary_in_the_tutorial():
    line = MorseFormatter().format(record("-        SIMULATION SUMMARY        -", seconds=0.284))
    assert line == "[    0.284] -        SIMULATION SUMMARY        -"


@pytest.mark.parametrize("name", ["morse", "morse.main", "blender.main"])
def test_main_loggers_have_no_prefix(name):
    assert MorseFormatter().format(record("hello", name=name)) == "[    0.283] hello"


@pytest.mark.parametrize(
    ("name", "prefix"),
    [
        ("morse.morse.core.request_manager", "[core.request_manager] "),
        ("morse.ranger_sim.actuators.eyes", "[actuators.eyes] "),
        ("morse.builder", "[morse.builder] "),
    ],
)
def test_prefix_is_the_last_two_parts_of_the_name(name, prefix):
    assert MorseFormatter().format(record("hello", name=name)) == f"[    0.283] {prefix}hello"


@pytest.mark.parametrize("level", [logging.DEBUG, logging.INFO, logging.WARNING])
def test_lines_below_error_have_a_time_stamp(level):
    assert MorseFormatter().format(record("hello", level)).startswith("[    0.283] ")


@pytest.mark.parametrize("level", [logging.ERROR, logging.CRITICAL])
def test_errors_have_no_time_stamp(level):
    assert MorseFormatter().format(record("[ERROR][MORSE] oh", level)) == "[ERROR][MORSE] oh"


def test_titles():
    formatter = MorseFormatter()
    assert formatter.format(record("SCENE INITIALIZATION", SECTION)) == "\n[SCENE INITIALIZATION]"
    assert formatter.format(record("SCENE INITIALIZED", ENDSECTION)) == "[SCENE INITIALIZED]"
    assert (SECTION, ENDSECTION) == (25, 23)


def test_percent_signs_in_messages_survive():
    assert MorseFormatter().format(record("100 %s")).endswith("100 %s")
    assert MorseFormatter().format(record("%d%%", logging.INFO, "morse.a%s.b", 0.0, 5)).endswith("[a%s.b] 5%")


def test_a_traceback_follows_the_line():
    try:
        raise KeyError("left_eye")
    except KeyError:
        text = MorseFormatter().format(record("oh", logging.ERROR, error=sys.exc_info()))
    assert text.splitlines()[0] == "oh"
    assert text.splitlines()[-1] == "KeyError: 'left_eye'"


def test_formatting_twice_gives_the_same():
    line = record("hello", name="morse.a.b")
    formatter = MorseFormatter()
    assert formatter.format(line) == formatter.format(line)


@pytest.mark.parametrize("scheme", ["bright", "dark", "xmas"])
@pytest.mark.parametrize("level", [logging.DEBUG, logging.INFO, logging.WARNING, logging.ERROR, SECTION, ENDSECTION])
def test_colors_change_nothing_but_the_color(scheme, level):
    colored = MorseFormatter(scheme).format(record("hello", level))
    assert re.sub(r"\033\[[\d;]*m", "", colored) == MorseFormatter().format(record("hello", level))
    assert colored.count("\033[0m") == (colored.count("\033[") > 0)


def test_errors_stand_out_from_warnings():
    for scheme in ("bright", "dark"):
        formatter = MorseFormatter(scheme)
        assert len({formatter.format(record("x", level))[:6] for level in (30, 40, 20)}) == 3


def test_xmas_alternates():
    formatter = MorseFormatter("xmas")
    first, second, third = (formatter.format(record("x")) for _ in range(3))
    assert first != second
    assert first == third


def test_unknown_colors_are_refused():
    with pytest.raises(ValueError, match="mono, bright, dark, xmas"):
        MorseFormatter("pink")


def test_unknown_level_is_refused():
    with pytest.raises(ValueError, match="LOUD"):
        log.setup(level="LOUD")


def test_setup_twice_writes_each_line_once(capsys):
    log.setup()
    log.setup(level="DEBUG")
    logging.getLogger("morse.some.thing").debug("once")
    log.section("TITLE")
    log.endsection("TITLE")
    out = capsys.readouterr().out
    assert re.fullmatch(r"\[ *\d+\.\d{3}\] \[some\.thing\] once\n\n\[TITLE\]\n\[TITLE\]\n", out)


def test_default_level_is_info(capsys):
    log.setup(level="INFO")
    logging.getLogger("morse.x").debug("quiet")
    logging.getLogger("morse.x").info("loud")
    out = capsys.readouterr().out
    assert "quiet" not in out
    assert "loud" in out


SESSION = """
import logging, os, signal
from morse.core.reports import log
log.setup(colors={colors!r})
print("printed")
logging.getLogger("morse").warning("careful")
log.endsection("DONE")
logging.getLogger("morse").info("nach Größe")
os._exit(0)  # nothing is flushed by the interpreter
"""


def run_session(colors, **variables):
    return subprocess.run(
        [sys.executable, "-c", SESSION.format(colors=colors)],
        capture_output=True,
        env={**ENVIRONMENT, **variables},
        timeout=60,
        check=True,
    )


def test_every_line_is_flushed_in_order():
    lines = run_session("mono").stdout.decode().splitlines()
    assert lines[0] == "printed"
    assert lines[1].endswith("careful")
    assert lines[2] == "[DONE]"
    assert lines[3].endswith("nach Größe")


def test_no_colors_in_a_pipe():
    assert b"\033" not in run_session("bright").stdout


def test_no_line_is_lost_to_an_ascii_terminal():
    result = run_session("mono", PYTHONIOENCODING="ascii")
    assert result.stdout.splitlines()[-1].endswith(b"nach Gr\\xf6\\xdfe")
    assert result.stderr == b""


def test_colors_on_a_terminal():
    child = pexpect.spawn(sys.executable, ["-c", SESSION.format(colors="bright")], env=ENVIRONMENT, timeout=60)
    child.expect(pexpect.EOF)
    assert re.search(rb"\033\[93m\[ *\d+\.\d{3}\] careful\033\[0m", child.before)


def test_no_colors_on_a_terminal_unless_asked():
    child = pexpect.spawn(sys.executable, ["-c", SESSION.format(colors="mono")], env=ENVIRONMENT, timeout=60)
    child.expect(pexpect.EOF)
    assert b"\033" not in child.before


def test_a_reader_that_leaves_disturbs_nothing(monkeypatch):
    class Gone(io.StringIO):
        def write(self, text):
            raise BrokenPipeError

    log.setup()
    complaints = io.StringIO()
    monkeypatch.setattr(sys, "stdout", Gone())
    monkeypatch.setattr(sys, "stderr", complaints)
    logging.getLogger("morse").info("to nobody")
    assert complaints.getvalue() == ""


@pytest.mark.parametrize("forged", ["a\n[ERROR][MORSE] b", "a\r[ERROR][MORSE] b", "\x1b[2J", "\x9b2J", "a\u2028b", "‮"])
def test_no_text_can_look_like_a_record_or_control_the_terminal(forged):
    try:
        raise ValueError(forged)
    except ValueError:
        error = sys.exc_info()
    for made in (record("it says %s", logging.ERROR, "morse", 0.1, forged), record("it fails", error=error)):
        lines = MorseFormatter().format(made).split("\n")
        assert all(line.replace("…", "").isprintable() for line in lines)
        assert not any(line.startswith("[ERROR]") for line in lines)


def test_a_lone_surrogate_can_be_written_to_any_file(tmp_path):
    handler = logging.FileHandler(tmp_path / "log", encoding="utf-8")
    handler.setFormatter(MorseFormatter())
    handler.handle(record("it says %s", logging.INFO, "morse", 0.1, "\ud800"))
    handler.close()
    assert "\\ud800" in (tmp_path / "log").read_text()


def test_modules_of_the_simulator_name_their_loggers_once():
    sources = Path(morse.__file__).parent
    wrong = [path for path in sources.rglob("*.py") if '"morse." + __name__' in path.read_text(encoding="utf-8")]
    assert wrong == []


@pytest.mark.parametrize("name", ["core.request_manager", "morse.core.request_manager", "core"])
def test_a_level_that_is_set_has_an_effect(name):
    import morse.core.request_manager as module

    loggers = logging.getLogger("morse.core"), module.logger
    try:
        log.set_level(name, "debug")
        assert module.logger.isEnabledFor(logging.DEBUG)
        log.set_level(name, "ERROR")
        assert not module.logger.isEnabledFor(logging.WARNING)
    finally:
        for logger in loggers:
            logger.setLevel(logging.NOTSET)


@pytest.mark.parametrize("name", ["", ".", "a..b", "." * 60_000, "a." * 9 + "a", "x" * 200, "a\nb"])
def test_a_name_that_would_only_take_memory_is_refused(name):
    before = len(logging.root.manager.loggerDict)
    with pytest.raises(ValueError, match="is not a name of a logger"):
        log.set_level(name, "debug")
    assert len(logging.root.manager.loggerDict) == before
