"""A recorded run that can be played forward and backward: its inputs are replayed, and states are saved."""

from __future__ import annotations

import bisect
import logging
from typing import TYPE_CHECKING, Any, NamedTuple

from morse.simulation.recordings.input_recording import ReplayError
from morse.simulation.recordings.replaying import Replay

if TYPE_CHECKING:
    from morse.simulation.recordings.input_recording import InputRecording
    from morse.simulation.running import Running
    from morse.simulation.states.state import State

logger = logging.getLogger(__name__)

#: initial number of ticks between two states
_EVERY = 30
#: maximum number of states; above it, every second state is removed
_MOST = 600


class _Kept(NamedTuple):
    position: int
    state: State
    replay: Any


class Timeline:
    """A simulation at any tick of a recorded run.

    Positions count ticks since the beginning of the recording. Resets and restored states do not decrease them.

    Args:
        simulation: a simulation of the scene; it is set to the beginning of the recording.
        recording: the inputs.
        length: number of ticks of the whole recording.

    Attributes:
        position: ticks since the beginning.
        length: the last position.

    Raises:
        StateError: the recording belongs to another scene.
    """

    def __init__(self, simulation: Running, recording: InputRecording, length: int) -> None:
        self._simulation = simulation
        self._replay = Replay(simulation, recording)
        self.length = length
        self.position = 0
        self._every = _EVERY
        self._moments: list[_Kept] = []
        self._keep()

    @property
    def at_end(self) -> bool:
        """Whether the end of the recording was reached."""
        return self.position >= self.length or self._replay.done

    def forward(self) -> None:
        """Run one tick; the run ends at an input that does not fit it, which is logged."""
        try:
            self._replay.step()
        except ReplayError as error:
            logger.error("[ERROR][MORSE] the run cannot be shown further: %s", error)
            self.length = self.position
            return
        self.position += 1
        if self.position > self._moments[-1].position + self._every - 1:
            self._keep()

    def _keep(self) -> None:
        self._moments.append(_Kept(self.position, self._simulation.silent_state(), self._replay.place()))
        if len(self._moments) > _MOST:
            del self._moments[1::2]
            self._every *= 2

    def approach(self, target: int) -> bool:
        """Move towards a position by one tick, or by restoring a saved state.

        Returns:
            Whether the position is reached, or the recording ends before it.
        """
        target = max(0, min(target, self.length))
        nearest = self._moments[bisect.bisect_right(self._moments, target, key=lambda moment: moment.position) - 1]
        if target < self.position or nearest.position > self.position:
            self._simulation.restore(nearest.state)
            self._replay.go_to(nearest.replay)
            self.position = nearest.position
        elif self.position < target and not self.at_end:
            self.forward()
        return self.position == target or self.at_end
