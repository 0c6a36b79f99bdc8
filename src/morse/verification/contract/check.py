"""Checks components against all rules."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.declarations import levels
from morse.verification.contract.behaviour import DETERMINISTIC, FITS, JSON, RESET, SAVED, well_behaved
from morse.verification.contract.carried import CARRIED, carried
from morse.verification.contract.declared import DECLARED, DOCUMENTED, declared, documented
from morse.verification.contract.report import Fault, Report
from morse.verification.contract.rough import CALLS, COMMANDS, Rough
from morse.verification.contract.rules import LOADS
from morse.verification.contract.said import Said
from morse.verification.contract.stand import Stand, set_up
from morse.verification.contract.subjects import Subject, SubjectError, subjects

if TYPE_CHECKING:
    import os


def check_component(what: str | os.PathLike[str], robot: str | None = None) -> list[Report]:
    """Check the contract that every component follows.

    Each component runs in several simulations of some seconds, without sockets, in this process.

    Args:
        what: the name of a class of `morse.builder`, or the path of a file with classes of components: each is checked.
        robot: the class of its robot: one of `morse.builder`, or ``package.module.Class`` in the
            project of the file. None to try those of MORSE.

    Returns:
        A report for each component.

    Raises:
        SubjectError: there is nothing to check.
    """
    with Said() as said:
        return [_check(subject, robot, said) for subject in subjects(what)]


def _check(subject: Subject, robot: str | None, said: Said) -> Report:
    report = Report(subject.name, checked=[LOADS])
    try:
        stand = set_up(subject, said, robot)
    except SubjectError as error:
        report.faults.append(Fault(LOADS, str(error)))
        return report
    with stand:
        cls = type(stand.component)
        report.where, report.robot = stand.places.of_class(cls), stand.robot
        report.checked += [DOCUMENTED, DECLARED]
        report.faults += [*documented(cls, stand.places), *declared(cls, stand.places)]
        names = [None, *(name for name, level in levels(cls).items() if not level.default)]
        report.checked += [FITS, JSON, DETERMINISTIC, SAVED, RESET]
        for name in names:
            _run(subject, stand, name, said, report)
        if not stand.failed and not report.of(JSON):
            report.checked += [CARRIED, COMMANDS, CALLS]
            stand.simulation.restart(seed=1)
            report.faults += carried(stand)
            stand.simulation.restart(seed=1)
            report.faults += Rough(stand, said).faults()
    return report


def _run(subject: Subject, stand: Stand, level: str | None, said: Said, report: Report) -> None:
    """Run a component at one of its levels."""
    carrier = stand.carrier

    def other() -> Stand:
        return set_up(subject, said, carrier, level)

    if level is None:
        report.faults += well_behaved(stand, other, said)
        return
    with other() as own:
        for fault in well_behaved(own, other, said):
            report.faults.append(fault._replace(text=f"at the level '{level}': {fault.text}"))
