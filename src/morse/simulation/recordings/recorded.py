"""Recordings of a simulation: its inputs in memory, the whole run in files."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.context import acting
from morse.simulation.recordings.input_recording import InputRecorder
from morse.simulation.recordings.replaying import Replay

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Sequence

    from morse.recording.recorder import Recorder
    from morse.simulation.recordings.flight_recorder import FlightRecorder
    from morse.simulation.recordings.input_recording import InputRecording
    from morse.simulation.running import Running
    from morse.simulation.states.saving import Saving
    from morse.simulation.states.state import State


class Recorded:
    """The part of `morse.simulation.simulation.Simulation` that records and replays.

    Attributes:
        recorders: the active recordings in files.
        flight_recorder: keeps the last seconds before a failure, or None.
    """

    def __init__(self) -> None:
        super().__init__()
        self._saving: Saving
        self.recorders: list[Recorder] = []
        self.flight_recorder: FlightRecorder | None = None

    def record(self: Running, path: str | os.PathLike[str], sensors: Sequence[str] | None = None) -> Recorder:
        """Record the run in an MCAP file: sensors, frames, log, and all inputs.

        The recording continues until `Recorder.stop`, the end of a ``with`` block, or the end of the simulation.

        Args:
            path: path of the file, which must not exist.
            sensors: full names of the recorded sensors; None for all, empty for only inputs and the log.

        Raises:
            RecordingError: the file exists or cannot be written, or there is no such sensor.
        """
        from morse.simulation.recordings.recorders import start_recording

        self._check_open()
        with acting(self.context):
            return start_recording(self, path, sensors)

    def silent_state(self) -> State:
        """The complete state, as from `save`, without warnings about values that cannot be saved."""
        return self._saving.save(tell=False)

    def end_recordings(self) -> None:
        """Complete the files of all recordings; errors are logged."""
        for recorder in list(self.recorders):
            recorder.close()

    def record_inputs(self: Running) -> InputRecorder:
        """Record all inputs from now on; see `replay`."""
        return InputRecorder(self)

    def replay(
        self: Running,
        recording: InputRecording,
        each_tick: Callable[[], object] | None = None,
        *,
        results: bool = True,
    ) -> None:
        """Replay a recording from its beginning to its end, bit for bit.

        Args:
            recording: recording of a simulation of the same scene.
            each_tick: callback, called after every tick.
            results: whether the results of services have to be the same.

        Raises:
            StateError: the recording belongs to another scene, or an input does not fit the run: it has another
                outcome, for example.
        """
        self._check_open()
        Replay(self, recording, results=results).run(each_tick)
