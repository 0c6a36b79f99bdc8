"""``morse replay``: look at a recorded run again."""

from __future__ import annotations

from typing import Annotated

import typer

from morse.cli.messages import CommandError, complain, say
from morse.core import log

CONTEXT_SETTINGS = {"allow_interspersed_args": True}


def command(
    file: Annotated[str, typer.Argument(metavar="FILE.mcap", help="A recording.", show_default=False)],
    resimulate: Annotated[
        bool, typer.Option("--resimulate", help="Run scene, seed and inputs again, and compare every message.")
    ] = False,
    scene: Annotated[
        str | None,
        typer.Option("--scene", metavar="PATH", help="The scene script, if it is not the one that was recorded."),
    ] = None,
    record: Annotated[
        str | None,
        typer.Option("--record", metavar="NEW.mcap", help="Record the run that is simulated again, with all sensors."),
    ] = None,
) -> int:
    """Run a recorded simulation again, and say whether it is the same.

    The scene is simulated with the seed and the inputs of the recording. Every message is compared with the recorded
    one, to the bit; if one differs, its tick and its first field that differs are named.
    """
    if not resimulate:
        raise CommandError("Say --resimulate: the run is simulated again and compared with the recording.", 2)
    return _resimulate(file, scene or "", record)


def _resimulate(path: str, scene: str, record: str | None) -> int:
    from morse.core.exceptions import MorseError
    from morse.recording.recording import Recording
    from morse.simulation.faults import describe
    from morse.verification.resimulation import resimulate

    try:
        with Recording(path) as recording:
            say(f"Simulating {recording.facts.get('environment') or path} again, to tick {recording.last_tick()} ...")
            if not recording.complete:
                say("The recording breaks off: what is there is compared.")
            if failure := recording.end.get("failure"):
                say(f"It was recorded before a failure: {failure}")
            log.setup(level="WARNING")
            outcome = resimulate(recording, scene, say, record)
    except MorseError as error:
        raise CommandError(str(error)) from None
    except (ValueError, LookupError) as error:
        raise CommandError(f"The scene cannot be simulated again: {describe(error)}") from None
    if outcome.departure is not None:
        tick, what, how = outcome.departure
        complain(f"Not the same: the run departs from the recording at tick {tick}, in {what}: {how}.")
        return 1
    if outcome.failure:
        complain(f"The run breaks off after {outcome.ticks} ticks: {outcome.failure}")
        return 1
    if not outcome.messages:
        say(f"{outcome.ticks} ticks were simulated again; the recording holds no messages to compare them with.")
        return 0
    with_state = ", and so is the state at the end" if outcome.complete else ""
    say(f"The same to the bit: {outcome.messages} messages of {outcome.ticks} ticks{with_state}.")
    return 0
