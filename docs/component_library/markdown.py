"""Pieces of Markdown."""

from __future__ import annotations

import inspect
import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

_SECTION = re.compile(r"^(Args|Returns|Raises|Attributes|Yields|Note):\s*$", re.MULTILINE)
_ARGUMENT = re.compile(r"^ {4}(\w+)(?: \([^)]*\))?: (.+(?:\n {8}.+)*)", re.MULTILINE)


def table(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A table, or nothing if it has no rows."""
    lines = [f"| {' | '.join(cell(value) for value in row)} |" for row in rows]
    if not lines:
        return ""
    return "\n".join([f"| {' | '.join(head)} |", f"|{'---|' * len(head)}", *lines]) + "\n"


def cell(value: object) -> str:
    """Text that fits into one cell."""
    return " ".join(str(value).split()).replace("|", "\\|")


def code(value: object) -> str:
    """A value as code."""
    text = str(value)
    return f"`{text}`" if text else ""


def block(language: str, text: str) -> str:
    """A block of code."""
    return f"```{language}\n{text.strip()}\n```\n"


def section(title: str, *parts: str, depth: int = 2) -> str:
    """A heading with its text, or nothing if the text is empty."""
    body = "\n".join(part for part in parts if part)
    return f"{'#' * depth} {title}\n\n{body}" if body else ""


def page(title: str, *parts: str) -> str:
    """A whole page."""
    body = "\n\n".join(part.strip() for part in parts if part.strip())
    return f"# {title}\n\n{body}\n"


def prose(docstring: str | None) -> str:
    """A docstring without the parts that list arguments, results and errors."""
    text = inspect.cleandoc(docstring or "")
    found = _SECTION.search(text)
    return _own_code(text[: found.start()] if found else text).strip()


def arguments(docstring: str | None) -> list[tuple[str, str]]:
    """Names and descriptions of the arguments that a docstring explains."""
    text = inspect.cleandoc(docstring or "")
    start = re.search(r"^Args:\s*$", text, re.MULTILINE)
    if start is None:
        return []
    rest = text[start.end() :]
    end = _SECTION.search(rest)
    return [
        (name, " ".join(_own_code(what).split()))
        for name, what in _ARGUMENT.findall(rest[: end.start()] if end else rest)
    ]


def _own_code(text: str) -> str:
    """Indented code of docstrings as fenced Markdown code; the rest is unchanged."""
    return re.sub(r"``(.+?)``", r"`\1`", text).replace("::\n", ":\n")
