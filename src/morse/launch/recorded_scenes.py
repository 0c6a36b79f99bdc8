"""The scene of a recorded run that is shown: that which the recording describes, else that of a script."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from morse.core.journal import EDIT
from morse.core.reports.quoting import quoted
from morse.launch.load import described
from morse.launch.recorded_run import options_of, plain_options
from morse.recording.errors import RecordingError
from morse.recording.made.reading import RecordedMade
from morse.simulation.recordings.recorded_timeline import RecordedTimeline

if TYPE_CHECKING:
    import contextlib
    from collections.abc import Callable, Sequence

    from morse.recording.recording import Recording
    from morse.scene import Scene
    from morse.simulation.options import RunOptions
    from morse.simulation.recordings.input_recording import InputRecording


class ShownScene(NamedTuple):
    """A scene, and how it is run.

    Attributes:
        is_described: whether the recording describes the scene, so that no script was executed.
    """

    scene: Scene
    options: RunOptions
    is_described: bool


def shown_scene(
    recording: Recording,
    inputs: InputRecording,
    scene: str,
    trust: bool,
    stack: contextlib.ExitStack,
    say: Callable[[str], object],
    projects: Sequence[str] = (),
) -> ShownScene:
    """The scene of a recording, without servers.

    Args:
        inputs: of the recording.
        scene, trust, stack, told, projects: see `morse.launch.recorded_run.options_of`.

    Raises:
        RecordingError: the recording is damaged; or it does not describe its scene, and its script is not trusted.
    """
    reason = "" if scene else _lack(recording, inputs)
    if not scene and not reason:
        # what is simulated again needs the behaviour of each component
        products = RecordedMade(recording, tuple, exact=not RecordedTimeline.is_possible(recording, inputs))
        try:
            return ShownScene(products.scene(), plain_options(recording), True)
        except RecordingError as error:
            if RecordedTimeline.is_possible(recording, inputs):
                raise
            reason = f"The recording contains only the inputs of the run, which has to be simulated again, and {error}"
    try:
        options = options_of(recording, scene, trust, stack, say, projects)
    except RecordingError as error:
        raise RecordingError(f"{error}. {reason}") from None
    return ShownScene(described(options.script, options), options, False)


def _lack(recording: Recording, inputs: InputRecording) -> str:
    """Why a recording needs a script to be shown; empty if it does not."""
    edited = next((entry.name for entry in inputs.entries if entry.kind == EDIT), None)
    if edited is not None:
        return f"The recording alone cannot be shown, because {quoted(edited)} was edited during the run"
    if not RecordedMade.describe_the_scene(recording):
        return "The recording is of an earlier version or of a failure: it contains no meshes, materials and components"
    return ""
