"""The scene of a recorded run that is shown: that which the recording describes, else that of a script."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.journal import EDIT
from morse.core.reports.quoting import quoted
from morse.launch.load import described
from morse.launch.recorded_run import options_of, plain_options
from morse.middleware.ros2.mapping import MIDDLEWARE
from morse.recording.errors import RecordingError
from morse.recording.made.reading import RecordedMade
from morse.simulation.recordings.recorded_timeline import RecordedTimeline

if TYPE_CHECKING:
    import contextlib
    from collections.abc import Callable, Mapping, Sequence

    from morse.recording.recording import Recording
    from morse.scene import Scene
    from morse.simulation.options import RunOptions
    from morse.simulation.recordings.input_recording import InputRecording


class ShownScene(NamedTuple):
    """A scene, and what determines the topics of its sensors.

    Attributes:
        is_described: whether the recording describes the scene, so that no script was executed.
        naming: options of the stream manager of ROS 2.
        topics: options of the stream of ROS 2 of each sensor.
    """

    scene: Scene
    options: RunOptions
    is_described: bool
    naming: Mapping[str, Any]
    topics: Mapping[str, Mapping[str, Any]]


def shown_scene(
    recording: Recording,
    inputs: InputRecording,
    scene: str,
    trust: bool,
    stack: contextlib.ExitStack,
    told: Callable[[str], object],
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
        made = RecordedMade(recording, tuple, exact=not RecordedTimeline.is_possible(recording, inputs))
        try:
            found, naming = made.scene()
            return ShownScene(found, plain_options(recording), True, naming, made.topics)
        except RecordingError as error:
            if RecordedTimeline.is_possible(recording, inputs):
                raise
            reason = f"The recording contains only the inputs of the run, which has to be simulated again, and {error}"
    try:
        options = options_of(recording, scene, trust, stack, told, projects)
    except RecordingError as error:
        raise RecordingError(f"{error}. {reason}") from None
    read = described(options.script, options)
    manager = MIDDLEWARE.stream_manager or ""
    topics = {
        declared.name: next((stream.options for stream in declared.streams if stream.manager == manager), {})
        for declared in read.components
        if declared.kind == "sensor"
    }
    return ShownScene(read, options, False, read.manager_options.get(manager, {}), topics)


def _lack(recording: Recording, inputs: InputRecording) -> str:
    """Why a recording needs a script to be shown; empty if it does not."""
    edited = next((entry.name for entry in inputs.entries if entry.kind == EDIT), None)
    if edited is not None:
        return f"The recording alone cannot be shown, because {quoted(edited)} was edited during the run"
    if not RecordedMade.describe_the_scene(recording):
        return "The recording is of an earlier version or of a failure: it contains no meshes, materials and components"
    return ""
