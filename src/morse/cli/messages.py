"""Messages of the command line: one line per message, with the prefix ``* ``."""

from __future__ import annotations

import difflib
import os
from typing import TYPE_CHECKING

from morse.core.reports.printing import echo, harmless_paragraph
from morse.system.regular_files import expanded

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path


class CommandError(Exception):
    """A command failed; the message contains the reason and the correction.

    Args:
        message: text for the user.
        status: exit status of the process; 2 for options and arguments that the command does not take. A file that
            does not exist, or that holds something else, is a failed command: 1.
    """

    def __init__(self, message: str, status: int = 1) -> None:
        super().__init__(message)
        self.status = status


def say(message: str) -> None:
    """Print a message on the standard output."""
    echo(f"* {harmless_paragraph(message)}")


def warn(message: str) -> None:
    """Print a warning on the standard error."""
    echo(f"* Warning: {harmless_paragraph(message)}", err=True)


def complain(message: str) -> None:
    """Print the reason why a command failed on the standard error."""
    echo(f"* {harmless_paragraph(message)}", err=True)


def sentence(error: object) -> str:
    """The text of an error with a full stop at its end, or with its question mark."""
    text = str(error)
    return text if text.endswith(("?", ".", "!")) else f"{text}."


def existing_file(name: str | os.PathLike[str]) -> Path:
    """The path of a file that a command reads.

    Raises:
        CommandError: it does not exist, or is a folder.
    """
    path = expanded(name)
    if path.is_dir():
        raise CommandError(f"{name} is a folder, not a file.")
    if not path.is_file():
        beside = os.listdir(path.parent) if path.parent.is_dir() else []
        raise CommandError(f"There is no file {name}.{nearest(path.name, beside)}")
    return path


def check_other(output: str | os.PathLike[str] | None, source: str | os.PathLike[str]) -> None:
    """Check that a command does not write the file that it reads.

    Raises:
        CommandError: both are one file.
    """
    if output is not None and os.path.exists(output) and os.path.exists(source) and os.path.samefile(output, source):
        raise CommandError(f"{output} is the file that is read: give another name for the file that is written.", 2)


def nearest(word: str, candidates: Iterable[str], cutoff: float = 0.6) -> str:
    """A hint such as `` Did you mean 'ranger_sim'?``, or an empty string if no candidate is similar to the word."""
    by_folded = {candidate.lower(): candidate for candidate in candidates}
    matches = difflib.get_close_matches(word.lower(), by_folded, n=1, cutoff=cutoff)
    return f" Did you mean '{by_folded[matches[0]]}'?" if matches else ""
