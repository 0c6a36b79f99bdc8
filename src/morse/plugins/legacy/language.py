"""Python 2 and early Python 3 in scene scripts: what a mistake most likely means, and how it is written today."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

#: a line with a syntax error; the mend; the pattern of its replacement
_LINES = (
    (r"^(\s*)print\b(?!\s*\()[ \t]*(.*?)[ \t]*$", "print is a function: print(...)", r"\1print(\2)"),
    (r"^(\s*)exec\b(?!\s*\()[ \t]*(.*?)[ \t]*$", "exec is a function: exec(...)", r"\1exec(\2)"),
    (r"^(\s*except\b[^:]*?)\s*,\s*(\w+)\s*:", "Write: except Error as error:", r"\1 as \2:"),
    (r"^(\s*raise\s+[\w.]+)\s*,\s*(.*?)\s*$", "Write: raise Error('message')", r"\1(\2)"),
    (r"<>", "Write != instead of <>", r"!="),
    (r"\bur(?=['\"])", "Write a string without u: r'...'", r"r"),
    (r"`([^`]+)`", "Write repr(...) instead of `...`", r"repr(\1)"),
    (r"(?<![\w.])0(\d+)\b", "Numbers do not begin with 0; octal numbers are written 0o17", r"0o\1"),
    (r"\b(\d+)[lL]\b", "Write integers without L", r"\1"),
    (r"\b(async|await)\b", "async and await are keywords since Python 3.7: rename the variable", r"\1_"),
)

#: names of Python 2, and those of today
NAMES: Mapping[str, str] = {
    "basestring": "str",
    "execfile": "exec(open(path).read())",
    "file": "open",
    "long": "int",
    "raw_input": "input",
    "reduce": "functools.reduce",
    "reload": "importlib.reload",
    "unichr": "chr",
    "unicode": "str",
    "xrange": "range",
}

#: names of versions before MORSE 1.4 that are gone, and what scripts write since
EARLIER: Mapping[str, str] = {
    "Middleware": "component.add_stream('socket')",
    "RobotCreator": "class MyRobot(GroundRobot), with GroundRobot.__init__(self, 'model', name)",
}

_ARGUMENTS = re.compile(r"sys\.argv\[\s*sys\.argv\.index\(\s*(['\"])--\1\s*\)\s*\+\s*1\s*:\s*\]")


def mend_of_syntax(error: SyntaxError) -> str:
    """How to correct a line that is not valid today; empty if unknown."""
    if isinstance(error, TabError):
        return "Indent with spaces only (in most editors: convert tabs to spaces)."
    line = (error.text or "").rstrip()
    return next((f"{mend}." for pattern, mend, _ in _LINES if re.search(pattern, line)), "")


def mended_line(line: str) -> str:
    """A line that is not valid today, as it is written today; unchanged if that is unknown."""
    for pattern, _, new in _LINES:
        new_line = re.sub(pattern, new, line)
        if new_line != line:
            return new_line
    return line


def mend_of_name(name: str) -> str:
    """How a name of Python 2, or of MORSE before 1.4, is written today; empty if it is none."""
    if name in EARLIER:
        return f"It is a name of a version before MORSE 1.4: write {EARLIER[name]}"
    return f"It is a name of Python 2: write {NAMES[name]}" if name in NAMES else ""


def mended_text(text: str) -> str:
    """A script that reads its arguments as they are given today."""
    return _ARGUMENTS.sub("sys.argv[1:]", text)
