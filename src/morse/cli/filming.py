"""A film of a recorded run."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.cli.messages import CommandError, say
from morse.cli.viewing import drawn, request_of, shape_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from morse.recording.recording import Recording

_FASTEST, _LONGEST = 1000.0, 1e6


class Filmed(NamedTuple):
    """The content of a film.

    Attributes:
        camera: name of a camera of the scene, or None.
        places: (x, y, z) of the viewpoint and of the point that it looks at, m; None for those of the script.
        size: width and height, px.
        fov: angle of view, degrees; None for the angle of the script.
        fine: whether four times as many samples are drawn.
        rate: frames per simulated second.
        begin, length: simulated seconds; a length of None is the rest of the recording.
    """

    camera: str | None
    places: tuple[Any, Any]
    size: tuple[int, int]
    fov: float | None
    fine: bool
    rate: float
    begin: float
    length: float | None

    def check(self) -> None:
        """Validate the numbers.

        Raises:
            CommandError: a number is out of range, or options exclude each other.
        """
        if not 0.0 < self.rate <= _FASTEST:
            raise CommandError(f"--rate is a number of frames per second up to {_FASTEST:g}, not {self.rate:g}.", 2)
        check_span(self.begin, self.length)
        if self.camera is not None and (self.places != (None, None) or self.fov is not None):
            raise CommandError(
                "--camera shows the image of a camera: it cannot be combined with --from, --at and --fov.", 2
            )


def check_span(begin: float, length: float | None) -> None:
    """Validate the part of a run that is shown, in simulated seconds.

    Raises:
        CommandError: a number is out of range.
    """
    if not 0.0 <= begin <= _LONGEST:
        raise CommandError(f"--begin is a number of simulated seconds, 0 or more, not {begin:g}.", 2)
    if length is not None and not 0.0 < length <= _LONGEST:
        raise CommandError(f"--length is a number of simulated seconds, not {length:g}.", 2)


def film(
    recording: Recording, path: Path, what: Filmed, scene: str, *, trust: bool, projects: Sequence[str] = ()
) -> None:
    """Write a film of a recorded run, from its recorded poses or, without them, from a simulation of its inputs.

    Args:
        recording: recording of the run.
        path: path of the film.
        what: content of the film.
        scene: path of a scene script; empty for the scene that the recording describes, or else its script.
        trust, projects: see `morse.launch.recorded_run.options_of`.

    Raises:
        CommandError: there is no such camera, or the recording ends before the film begins.
        MorseError: the run cannot be simulated again.
        OSError: the film cannot be written.
    """
    from morse.launch.timelines import timeline_of
    from morse.rendering import picture_files
    from morse.simulation.recordings.recorded_timeline import RecordedTimeline

    with contextlib.ExitStack() as stack:
        simulation, timeline = timeline_of(recording, stack, scene, say, trust=trust, projects=projects)
        frequency = simulation.clock.frequency
        first = round(what.begin * frequency)
        last = timeline.length if what.length is None else first + round(what.length * frequency)
        video: Any = None
        frames = absent = 0
        while (position := first + round(frames * frequency / what.rate)) < min(last, timeline.length):
            while not timeline.approach(position):
                pass
            if timeline.position < position:
                break
            frames += 1
            if isinstance(timeline, RecordedTimeline) and what.camera not in (None, *simulation.context.components):
                # its robot may have been spawned later, or deleted
                absent += 1
                continue
            # a restart creates new components
            request = request_of(simulation, what.camera, what.places, what.size, what.fov, what.fine, color=True)
            if video is None:
                video = picture_files.film(path, shape_of(request, what.fine), what.rate)
            video.add(drawn(request, "color", what.fine))
        if video is None and absent:
            timeline.approach(first)
            request_of(simulation, what.camera, what.places, what.size, what.fov, what.fine, color=True)
        if video is None:
            end = timeline.length / frequency
            raise CommandError(f"The recording ends after {end:g} s, before the film begins.")
        video.close()
    drawn_frames = frames - absent
    without = f", without {absent / what.rate:g} s in which there is no {what.camera}" if absent else ""
    say(f"{path}: {drawn_frames} frames of {drawn_frames / what.rate:g} s{without}.")
