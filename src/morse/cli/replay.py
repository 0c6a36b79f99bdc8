"""``morse replay``: show a recorded run."""

from __future__ import annotations

from typing import Annotated

import typer

from morse.cli.messages import CommandError, complain, existing_file, say
from morse.cli.sites import registered
from morse.core.reports import log

CONTEXT_SETTINGS = {"allow_interspersed_args": True}


def command(
    file: Annotated[str, typer.Argument(metavar="FILE.mcap", help="A recording.", show_default=False)],
    resimulate: Annotated[
        bool,
        typer.Option(
            "--resimulate", help="Simulate the run again from scene, seed and inputs, and compare every message."
        ),
    ] = False,
    scene: Annotated[
        str | None,
        typer.Option("--scene", metavar="PATH", help="Scene script to execute, instead of the recorded scene."),
    ] = None,
    trust: Annotated[
        bool,
        typer.Option(
            "--trust",
            help="Execute the script that the recording names or contains, with its arguments: only if you trust its "
            "sender.",
        ),
    ] = False,
    record: Annotated[
        str | None,
        typer.Option("--record", metavar="NEW.mcap", help="Record the run that is simulated again, with all sensors."),
    ] = None,
    view_port: Annotated[int, typer.Option("--view-port", min=0, max=65535, help="Port of the page (0: any).")] = 8765,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page in a browser.")] = True,
) -> int:
    """Show a recorded run.

    The page of the live view shows the run, with a timeline for jumping, dragging, and playing forward and backward at
    any speed. It shows the recorded scene and poses, and executes nothing.

    With --resimulate there is no page: every message is compared with the recorded message, bit for bit. If a message
    differs, its tick and the first different field are printed. This needs the scene script, and so does a page for a
    recording of the inputs alone: without --scene and --trust, it is executed only if it stands in the folder of an
    environment that you have registered by `morse create` or `morse import`.
    """
    if record is not None and not resimulate:
        raise CommandError("--record belongs to --resimulate: it records the new simulation of the run.", 2)
    existing_file(file)
    work = _resimulate if resimulate else _play
    return work(file, scene or "", record, trust, view_port, browser)


def _play(path: str, scene: str, _record: str | None, trust: bool, port: int, browser: bool) -> int:
    from morse.core.exceptions import MorseError
    from morse.core.reports.faults import describe
    from morse.launch.playing import play, playing
    from morse.recording.recording import Recording

    log.setup()
    try:
        with (
            Recording(path) as recording,
            playing(recording, scene, say, trust=trust, projects=registered(), port=port, browser=browser) as view,
        ):
            play(view)
    except MorseError as error:
        raise CommandError(str(error)) from None
    except (ValueError, LookupError) as error:
        raise CommandError(f"The scene cannot be simulated again: {describe(error)}") from None
    return 0


def _resimulate(path: str, scene: str, record: str | None, trust: bool, _port: int, _browser: bool) -> int:
    from morse.core.exceptions import MorseError
    from morse.core.reports.faults import describe
    from morse.recording.recording import Recording
    from morse.verification.resimulation import resimulate

    try:
        with Recording(path) as recording:
            say(f"Simulating {recording.facts.get('environment') or path} again, to tick {recording.last_tick()} ...")
            if not recording.complete:
                say("The recording is incomplete: its intact part is compared.")
            if failure := recording.end.get("failure"):
                say(f"It was recorded before a failure: {failure}")
            log.setup(level="WARNING")
            outcome = resimulate(recording, scene, say, record, trust=trust, projects=registered())
    except MorseError as error:
        raise CommandError(str(error)) from None
    except (ValueError, LookupError) as error:
        raise CommandError(f"The scene cannot be simulated again: {describe(error)}") from None
    if outcome.departure is not None:
        tick, what, how = outcome.departure
        place = f" It was made elsewhere: {outcome.elsewhere}." if outcome.elsewhere else ""
        complain(f"Different: the run differs from the recording from tick {tick} on, in {what}: {how}.{place}")
        return 1
    if outcome.failure:
        complain(f"The run stopped after {outcome.ticks} ticks: {outcome.failure}")
        return 1
    if outcome.rounding is not None:
        tick, what, how = outcome.rounding
        say(f"Equal but for rounding: {outcome.messages} messages of {outcome.ticks} ticks.")
        say(f"Largest difference: {how}, in {what} at tick {tick}. Made elsewhere: {outcome.elsewhere}.")
        return 0
    if outcome.complete and not outcome.messages:
        say(f"Equal to the bit: the state at the end of {outcome.ticks} ticks.")
        return 0
    if not outcome.messages:
        say(f"{outcome.ticks} ticks were simulated again; the recording contains no messages to compare.")
        return 0
    with_state = ", and so is the state at the end" if outcome.complete else ""
    say(f"Equal to the bit: {outcome.messages} messages of {outcome.ticks} ticks{with_state}.")
    return 0
