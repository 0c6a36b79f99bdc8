"""The one place that writes to the terminal beside the log: what comes from others cannot control it.

Names, topics, paths and texts of errors may contain anything: an escape sequence would change the title of the window,
write the clipboard, or hide what was printed before; characters without width or of the other direction show another
text.
"""

from __future__ import annotations

import contextlib
import sys
from typing import TYPE_CHECKING, Any

from morse.core.reports.quoting import escaped

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import Console


def harmless(text: str) -> str:
    """Escape what controls a terminal; ends of lines and tabs stay."""
    if text.isprintable():
        return text
    return "\n".join("\t".join(escaped(part) for part in line.split("\t")) for line in text.split("\n"))


def harmless_paragraph(text: str) -> str:
    """Escape what controls a terminal, and indent all lines but the first: none may look like another message."""
    if text.isprintable():
        return text
    first, *others = harmless(text).split("\n")
    return "\n".join([first, *(_continued(line.replace("\t", "    ")) for line in others)])


def _continued(line: str) -> str:
    return line if not line or line[0] == " " else "  " + line


def echo(text: object = "", *, err: bool = False, end: str = "\n", over: bool = False) -> None:
    """Print a text on the standard output, if it is open.

    Args:
        err: whether it is printed on the standard error.
        end: what follows.
        over: whether it replaces the line of a terminal on which the last text was printed.
    """
    stream = sys.stderr if err else sys.stdout
    if stream is None:
        return
    text = ("\r\x1b[K" if over else "") + harmless(str(text)) + end
    try:
        stream.write(text)
    except UnicodeEncodeError:
        encoding = stream.encoding or "ascii"
        stream.write(text.encode(encoding, "backslashreplace").decode(encoding))
    with contextlib.suppress(AttributeError):
        stream.flush()


def console() -> Console:
    """A console of rich for tables, whose cells are escaped as well."""
    # imported on demand: a project may have a file of this name, and few commands print tables
    from rich.console import Console
    from rich.segment import Segment

    class Escaping(Console):
        def render(self, *args: Any, **options: Any) -> Iterator[Segment]:
            for segment in super().render(*args, **options):
                yield segment if segment.control else Segment(harmless(segment.text), segment.style)

    return Escaping()
