"""What a script has that needs a change."""

from __future__ import annotations

from dataclasses import dataclass


def sentence(problem: str, mend: str) -> str:
    """A problem and its mend in one line."""
    if not mend:
        return problem
    return f"{problem}{'' if problem.endswith(('.', '?', '!')) else '.'} {mend}"


@dataclass(frozen=True, slots=True)
class Edit:
    """A change of the text of a script: within a statement, a word becomes another one.

    Attributes:
        old: the word, e.g. ``configure_mw``.
        new: the word of today.
    """

    old: str
    new: str


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing in a script that needs a change.

    Attributes:
        line: its line; 0 if unknown.
        message: what is wrong, and how it is written today.
        stops: whether the script does not run because of it.
        is_old: whether it is an old form, which still works.
        edit: the change, if it can be made without a person.
        file: another file of the project; empty for the script itself.
    """

    line: int
    message: str
    stops: bool = False
    is_old: bool = False
    edit: Edit | None = None
    file: str = ""
