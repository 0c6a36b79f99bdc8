"""The results of a check."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

from morse.core.reports.faults import describe, user_frames

if TYPE_CHECKING:
    from collections.abc import Iterable


class Fault(NamedTuple):
    """A violation of a rule.

    Attributes:
        rule: its name, see `morse.verification.contract.check.RULES`.
        text: the fault, the expected value, and how to correct it.
        where: file and line of the declaration; empty if there is none.
    """

    rule: str
    text: str
    where: str = ""

    def __str__(self) -> str:
        return f"{self.rule}: {self.text}{f' ({self.where})' if self.where else ''}"


@dataclass
class Report:
    """The outcome of the check of one component.

    Attributes:
        name: its name in scene scripts.
        where: file and line of its class; empty if it could not be loaded.
        robot: class of its robot; the component itself if it is a robot.
        checked: the rules that were checked, in order.
        faults: the violations.
    """

    name: str
    where: str = ""
    robot: str = ""
    checked: list[str] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        """Whether the component follows every rule."""
        return not self.faults

    def take(self, rule: str, faults: Iterable[Fault]) -> None:
        """Add faults; what the component raises while they are looked for is a fault, too.

        Args:
            rule: that such an exception breaks.
        """
        try:
            for fault in faults:
                self.faults.append(fault)
        except (Exception, SystemExit) as error:
            frames = user_frames(error.__traceback__)
            where = f"{frames[-1].filename}:{frames[-1].lineno}" if frames else self.where
            self.faults.append(Fault(rule, f"it raises {describe(error).partition(chr(10))[0]}", where))

    def of(self, rule: str) -> list[Fault]:
        """The faults of one rule."""
        return [fault for fault in self.faults if fault.rule == rule]

    def __str__(self) -> str:
        verdict = "keeps the contract" if self.passed else f"breaks it in {len(self.faults)} places"
        return "\n".join([f"{self.name} {verdict}", *(f"  {fault}" for fault in self.faults)])
