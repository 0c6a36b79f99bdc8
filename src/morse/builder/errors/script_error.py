"""Errors of scene scripts."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from morse.core.exceptions import MorseBuilderError
from morse.system.source_text import source_line

if TYPE_CHECKING:
    from morse.scene import SourceLine


_MAX_CALLERS = 8


@dataclass(slots=True)
class Step:
    """One line of user code in the traceback of an error.

    Attributes:
        function: the function that contains the line, or ``<module>``.
    """

    where: SourceLine
    function: str = "<module>"

    @property
    def source(self) -> str:
        """The text of the line, or an empty string if the file is not readable."""
        return source_line(self.where.file, self.where.line)

    def __str__(self) -> str:
        return f"{self.where}: {self.source}" if self.source else str(self.where)


@dataclass(eq=False)
class ScriptError(MorseBuilderError):
    """A scene script cannot be built.

    Attributes:
        message: one sentence with the given and the expected value.
        steps: the lines of user code in the traceback, outermost first, without code of MORSE.
        mend: the correction, or an empty string.
        script: the script that was run.
    """

    message: str
    steps: list[Step] = field(default_factory=list)
    mend: str = ""
    script: str = ""

    def __post_init__(self) -> None:
        super().__init__(self.message)

    @property
    def where(self) -> SourceLine | None:
        """The line with the error."""
        return self.steps[-1].where if self.steps else None

    def __str__(self) -> str:
        where = self.where
        return self.message if where is None else f"{where}: {self.message}"

    def report(self) -> str:
        """Return several lines for the user: location and message, source line, correction, callers."""
        lines = [f"{self.where or self.script or 'scene script'}: {self.message}"]
        if self.steps and (source := self.steps[-1].source):
            lines.append(f"    {source}")
        if self.mend:
            lines.append(f"  {self.mend}")
        callers = [f"  called from {step}" for step in reversed(self.steps[:-1])]
        if len(callers) > _MAX_CALLERS:
            half = _MAX_CALLERS // 2
            callers[half:-half] = [f"  ... and {len(callers) - 2 * half} more calls ..."]
        lines.extend(callers)
        return "\n".join(lines)
