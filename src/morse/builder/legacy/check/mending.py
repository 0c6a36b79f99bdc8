"""The text of a script with the changes that need no person."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from morse.builder.legacy import language
from morse.builder.legacy.check.syntax import parsed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.builder.legacy.check.finding import Edit, Finding

_ARGUMENTS = re.compile(r"sys\.argv\[\s*sys\.argv\.index\(\s*(['\"])--\1\s*\)\s*\+\s*1\s*:\s*\]")


def mended(text: str, findings: Sequence[Finding]) -> str:
    """The mended text; lines that nobody can mend but a person stay as they are.

    Raises:
        SyntaxError: the syntax cannot be mended line by line.
    """
    lines = _valid_where_possible(text).split("\n")
    spans = _spans("\n".join(lines))
    for finding in findings:
        if finding.edit is not None and not finding.file:
            first, last = spans.get(finding.line, (finding.line, finding.line))
            _replace(lines, finding.line, first, last, finding.edit)
    return _ARGUMENTS.sub("sys.argv[1:]", "\n".join(lines))


def _valid_where_possible(text: str) -> str:
    """The text with mended syntax, without the lines that ``parsed`` empties."""
    lines = (text.expandtabs(8) if _has_mixed_tabs(text) else text).split("\n")
    try:
        _, _, errors = parsed("\n".join(lines), "script")
    except SyntaxError:
        return "\n".join(lines)
    for number in {finding.line for finding in errors}:
        lines[number - 1] = language.mended_line(lines[number - 1])
    return "\n".join(lines)


def _has_mixed_tabs(text: str) -> bool:
    try:
        ast.parse(text)
    except TabError:
        return True
    except (SyntaxError, ValueError):
        return False
    return False


def _spans(text: str) -> dict[int, tuple[int, int]]:
    """The first and last line of the innermost statement at each line."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return {}
    spans: dict[int, tuple[int, int]] = {}
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt):
            first, last = node.lineno, node.end_lineno or node.lineno
            for line in range(first, last + 1):
                line_spans = spans.get(line)
                if line_spans is None or line_spans[1] - line_spans[0] >= last - first:
                    spans[line] = (first, last)
    return spans


def _replace(lines: list[str], line: int, first: int, last: int, edit: Edit) -> None:
    """Replace a word at a line, else at the next place in its statement."""
    if _replace_import(lines, line, edit):
        return
    # a word may be given in several spellings
    words = "|".join(re.escape(spelling) for spelling in edit.old.split("|"))
    word = re.compile(rf"(?<![\w.])(?:{words})(?!\w)" if "." in words else rf"(?<!\w)(?:{words})(?!\w)")
    for number in [*range(line, last + 1), *range(first, line)]:
        new_line = word.sub(lambda _: edit.new, lines[number - 1])
        if new_line != lines[number - 1]:
            lines[number - 1] = new_line
            return


def _replace_import(lines: list[str], line: int, edit: Edit) -> bool:
    """Replace a name in ``from module import name``; other names of the line stay."""
    module, _, name = edit.old.rpartition(".")
    match = re.match(rf"^(\s*)from\s+{re.escape(module)}\s+import\s+([\w, ]+?)\s*(#.*)?$", lines[line - 1])
    if not module or match is None:
        return False
    names = [word.strip() for word in match[2].split(",")]
    if name not in names:
        return False
    there, _, today = edit.new.rpartition(".")
    others = ", ".join(word for word in names if word != name)
    lines_after = [f"{match[1]}from {module} import {others}"] if others else []
    alias = f" as {name}" if today != name else ""
    lines[line - 1] = "\n".join([*lines_after, f"{match[1]}from {there} import {today}{alias}"])
    return True
