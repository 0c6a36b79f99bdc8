"""A recorded run, ready to be gone through: for films and for pages without a server."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.launch.load import start
from morse.launch.recorded_run import complete, guard, inputs_of
from morse.launch.recorded_scenes import shown_scene
from morse.simulation.recordings.recorded_timeline import RecordedTimeline
from morse.simulation.recordings.timeline import Timeline

if TYPE_CHECKING:
    import contextlib
    from collections.abc import Callable, Sequence

    from morse.recording.recording import Recording
    from morse.simulation.simulation import Simulation


def timeline_of(
    recording: Recording,
    stack: contextlib.ExitStack,
    scene: str,
    say: Callable[[str], object],
    *,
    trust: bool,
    projects: Sequence[str] = (),
) -> tuple[Simulation, Timeline | RecordedTimeline]:
    """The simulation of the scene of a recording, and its run: the recorded poses or, without them, the inputs.

    Args:
        recording: recording of the run.
        stack: closes the simulation.
        scene: path of a scene script; empty for the scene that the recording describes, or else its script.
        say: callback for messages to the user.
        trust, projects: see `morse.launch.recorded_run.options_of`.

    Raises:
        MorseError: the run cannot be simulated again.
    """
    inputs = inputs_of(recording, lenient=True)
    view = shown_scene(recording, inputs, scene, trust, stack, say, projects)
    simulation = stack.enter_context(start(view.scene, view.options))
    guard(simulation, described=view.is_described, trust=trust)
    if RecordedTimeline.is_possible(recording, inputs):
        return simulation, RecordedTimeline(simulation, recording, inputs, described=view.is_described)
    inputs = complete(recording, simulation, described=view.is_described)
    return simulation, Timeline(simulation, inputs, recording.length())
