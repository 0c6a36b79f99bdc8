"""Checks components against all rules."""

from __future__ import annotations

from itertools import chain
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
    from collections.abc import Callable, Iterable, Iterator


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
    with Said() as journal:
        return [_check(subject, robot, journal) for subject in subjects(what)]


def _check(subject: Subject, robot: str | None, journal: Said) -> Report:
    report = Report(subject.name, checked=[LOADS])
    try:
        stand = set_up(subject, journal, robot)
    except SubjectError as error:
        report.faults.append(Fault(LOADS, str(error)))
        return report
    with stand:
        cls = type(stand.component)
        report.where, report.robot = stand.places.of_class(cls), stand.robot
        report.checked += [DOCUMENTED, DECLARED]
        report.take(DECLARED, chain(documented(cls, stand.places), declared(cls, stand.places)))
        names = [None, *(name for name, level in levels(cls).items() if not level.default)]
        report.checked += [FITS, JSON, DETERMINISTIC, SAVED, RESET]
        for name in names:
            _run(subject, stand, name, journal, report)
        if not stand.failed and not report.of(JSON):
            report.checked += [CARRIED, COMMANDS, CALLS]
            report.take(CARRIED, _anew(stand, carried))
            report.take(CALLS, _anew(stand, lambda stand: Rough(stand, journal).faults()))
    return report


def _run(subject: Subject, stand: Stand, level: str | None, journal: Said, report: Report) -> None:
    """Run a component at one of its levels."""
    carrier = stand.carrier

    def other() -> Stand:
        return set_up(subject, journal, carrier, level)

    if level is None:
        report.take(FITS, well_behaved(stand, other, journal))
        return

    def at_level() -> Iterator[Fault]:
        with other() as own:
            for fault in well_behaved(own, other, journal):
                yield fault._replace(text=f"at the level '{level}': {fault.text}")

    report.take(FITS, at_level())


def _anew(stand: Stand, rule: Callable[[Stand], Iterable[Fault]]) -> Iterator[Fault]:
    stand.simulation.restart(seed=1)
    yield from rule(stand)
