"""Syntax errors of a script, all of them: each line is mended or emptied, until the rest is valid."""

from __future__ import annotations

import ast
import warnings

from morse.builder.legacy import language
from morse.builder.legacy.check.finding import Finding, sentence

_MOST = 200


def parsed(text: str, name: str) -> tuple[str, ast.Module, list[Finding]]:
    """The text with valid syntax, its tree, and the errors.

    Args:
        text: the script.
        name: its name in errors.

    Raises:
        SyntaxError: the text cannot be made valid line by line.
    """
    findings: list[Finding] = []
    first: SyntaxError | None = None
    while True:
        try:
            with warnings.catch_warnings():  # of lines that are mended; the others are told when the script is compiled
                warnings.simplefilter("ignore", SyntaxWarning)
                return text, ast.parse(text, name), findings
        except (SyntaxError, ValueError) as caught:
            error = caught if isinstance(caught, SyntaxError) else SyntaxError(str(caught))
            # later ones may be the consequences of a line that was left out
            first = first or error
        lines = text.split("\n")
        number = error.lineno or 0
        if not 1 <= number <= len(lines) or len(findings) >= _MOST:
            raise first
        mend = language.mend_of_syntax(error)
        findings.append(Finding(number, sentence(f"{type(error).__name__}: {error.msg}", mend), stops=True))
        if isinstance(error, TabError):
            text = text.expandtabs(8)
            continue
        line = lines[number - 1]
        mended = _with_colon(line, error) if error.msg == "expected ':'" else language.mended_line(line)
        # a line that stays wrong is left out; its block keeps a statement
        indent = line[: len(line) - len(line.lstrip())]
        lines[number - 1] = mended if mended != line else f"{indent}pass"
        if lines[number - 1] == line:
            raise first
        text = "\n".join(lines)


def _with_colon(line: str, error: SyntaxError) -> str:
    """The line of a block with the colon that it lacks, so that the lines of the block stay one."""
    place = max((error.offset or len(line) + 1) - 1, 0)
    return f"{line[:place].rstrip()}:{line[place:]}"
