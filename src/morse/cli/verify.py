"""``morse verify``: check that a scene is repeatable bit for bit."""

from __future__ import annotations

from typing import Annotated

import typer

from morse.cli.messages import CommandError, complain, say
from morse.cli.run import Length
from morse.cli.scenes import resolve

# options may follow the scene; arguments of the scene that begin with a dash come after "--"
CONTEXT_SETTINGS = {"allow_interspersed_args": True}


def command(
    scene: Annotated[
        list[str],
        typer.Argument(metavar="ENVIRONMENT [FILE] | PATH", help="The scene, as for `morse run`.", show_default=False),
    ],
    ticks: Annotated[int | None, typer.Option("--ticks", help="Ticks to compare (default: 600).")] = None,
    duration: Annotated[
        str | None,
        typer.Option("--duration", metavar="SECONDS", help="Simulated time to compare, s, instead of --ticks."),
    ] = None,
    seed: Annotated[int | None, typer.Option("--seed", min=0, help="Seed of all random numbers.")] = None,
) -> int:
    """Run a scene several times and compare every tick, to the bit.

    A new process, a restart and a run with the live view have to agree in the physics and in the data of every
    component. If they differ, the first different tick and component are printed.
    """
    from morse.simulation.ending import FAULTS
    from morse.verification.verify import ReplayError, verify

    length = Length.of(duration, ticks)
    resolved = resolve(scene)
    options = resolved.options(seed=seed, duration=length.seconds)
    count = length.ticks or (600 if length.seconds is None else None)
    failures: list[str] = []
    try:
        differences = verify(options, count, lambda text: say(f"Running {text} ..."), failed=failures.append)
    except ReplayError as error:
        raise CommandError(f"The scene did not run to the end:\n{error}") from None
    for difference in differences:
        complain(
            f"Not repeatable: {difference.runs} differ first in tick {difference.tick}, in '{difference.part}'. Look "
            "there for uses of the clock, of random numbers that are not from self.context.random(), of sets, and "
            "of threads."
        )
    if not differences:
        said = f"{length.seconds:g} s" if count is None else f"{count} ticks"
        say(f"Repeatable: {said} are equal to the bit.")
    if failures:
        complain(f"Switched off by faults:\n{failures[0]}")
    return 1 if differences else FAULTS if failures else 0
