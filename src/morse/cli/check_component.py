"""``morse check component``: check a component against the contract."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.cli.messages import CommandError, say, sentence
from morse.core.reports.printing import echo

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.verification.contract import Report

_USAGE = (
    "Give names or files: `morse check component Pose`, `morse check component my_sim/src/my_sim/sensors/sonar.py`."
)


def check_components(names: Sequence[str], robot: str | None) -> int:
    """Check components and print a report of each.

    Args:
        names: classes of scene scripts, or files.
        robot: class of the robot for the components.

    Returns:
        The exit status: 1 if a component breaks a rule.

    Raises:
        CommandError: no component was given.
    """
    if not names:
        raise CommandError(f"Which component? {_USAGE}", status=2)
    # imported on demand, because it loads the simulator
    from morse.verification.contract import SubjectError, check_component

    success = True
    for name in names:
        try:
            reports = check_component(name, robot)
        except SubjectError as error:
            raise CommandError(sentence(error)) from None
        for report in reports:
            _print(report)
            success &= report.passed
    return 0 if success else 1


def _print(report: Report) -> None:
    carrier = f", on {report.robot}" if report.robot and report.robot != report.name else ""
    echo(f"{report.name}{carrier}{f' ({report.where})' if report.where else ''}")
    for rule in report.checked:
        faults = report.of(rule)
        echo(f"  {'NO ' if faults else 'yes'} {rule}")
        for fault in faults:
            echo(f"      {fault.where or report.name}: {fault.text}")
    say(f"{report.name} satisfies the contract." if report.passed else f"{report.name}: {_count(len(report.faults))}.")


def _count(faults: int) -> str:
    return "1 fault" if faults == 1 else f"{faults} faults"
