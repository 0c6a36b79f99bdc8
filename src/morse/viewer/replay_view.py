"""The live view of a recorded run: a time line to jump, drag and play, forward and backward."""

from __future__ import annotations

import math
import time
from typing import TYPE_CHECKING, Any

from morse.recording.fields.blocks import RecordedFields
from morse.simulation.recordings.timeline import RecordedTimeline
from morse.viewer import page_messages as page
from morse.viewer.feeds.recorded import RecordedPicturesFeed, RecordedValuesFeed, cast_wished_rays
from morse.viewer.live_view import View
from morse.viewer.page import PageLeft
from morse.viewer.view_messages import History, Refused

if TYPE_CHECKING:
    from collections.abc import Callable

    import numpy as np
    from numpy.typing import NDArray

    from morse.recording.recording import Recording
    from morse.simulation.recordings.timeline import Timeline
    from morse.simulation.simulation import Simulation

#: maximum number of positions of the time line
_PLACES = 2000
#: maximum wall-clock seconds of work on a jump before messages of the page are processed
_PATIENCE = 0.03
#: wall-clock seconds between two frames while it plays backward
_FRAME = 1.0 / 30.0
#: wall-clock seconds between two polls of the page while nothing moves
_IDLE = 0.02


class _NoHistory:
    """The time line has the states of a recorded run itself."""

    def keep(self, *, paused: bool) -> None:
        """Keep nothing."""

    def restarted(self) -> None:
        """Forget nothing."""


class ReplayView(View):
    """Shows a recorded run. Commands, keys and services of the pages are refused.

    Args:
        simulation: the simulation of the scene.
        timeline: the recorded run.
        recording: the file of the run.
    """

    changeable = False

    def __init__(
        self,
        simulation: Simulation,
        timeline: Timeline,
        recording: Recording,
    ) -> None:
        self._timeline = timeline
        self._start = simulation.clock.time
        self._direction = 1
        self._target: int | None = None
        self._has_ended = False
        self._last_look = -1
        super().__init__(simulation)
        assert simulation.context.network is not None
        self._network = simulation.context.network
        self._history: Any = _NoHistory()
        self._recorded_timeline = timeline if isinstance(timeline, RecordedTimeline) else None
        fields = RecordedFields(recording)
        if self._recorded_timeline is not None:
            self._feeds[0] = RecordedValuesFeed(simulation.context, self._server, self._recorded_timeline, fields)
        self._pictures = RecordedPicturesFeed(
            simulation.context, self._server, fields, self._time, looks=self._recorded_timeline is not None
        )
        pacer = simulation.pacer
        handlers = dict.fromkeys(self._handlers, self._refuse)
        own: dict[type[Any], Callable[[Any], object]] = {
            page.Play: lambda _: self._play(1),
            page.PlayBackward: lambda _: self._play(-1),
            page.Pause: lambda _: self._play(0),
            page.Step: lambda event: self._go(timeline.position + event.count),
            page.StepBack: lambda _: self._go(timeline.position - 1),
            page.Rewind: lambda event: self._go(self._position(event.time)),
            page.Reset: lambda _: self._go(0),
            page.SetSpeed: lambda event: pacer.set_speed(event.factor or math.inf),
            page.Quit: lambda _: self.end(),
            page.ListenTo: lambda _: None,
            page.ToggleCapturing: lambda _: None,
            PageLeft: lambda _: None,
        }
        self._handlers = {**handlers, **own}

    def announce(self) -> None:
        """See `View.announce`."""
        super().announce()
        length, frequency = self._timeline.length, self._simulation.clock.frequency
        places = min(length, _PLACES)
        positions = [round(length * place / places) for place in range(places + 1)] if places else [0]
        self._server.send(History([self._start + position / frequency for position in positions], recorded=True))

    def before_tick(self) -> None:
        """Requests of the pages are processed between two ticks, by `run`."""

    def _is_paused(self) -> bool:
        return self._direction == 0

    def _time(self) -> float:
        """The time along the recording, which resets of the run do not set back."""
        return self._start + self._timeline.position / self._simulation.clock.frequency

    def _poses(self) -> NDArray[np.float32]:
        return self._timeline.poses()

    def after_tick(self) -> None:
        """See `View.after_tick`."""
        if self._recorded_timeline is not None and self._server.watched:
            self._look()
        super().after_tick()

    def _look(self) -> None:
        """Cast the rays that are shown from the recorded poses."""
        position = self._timeline.position
        if position == self._last_look:
            return
        self._last_look = position
        cast_wished_rays(self._simulation.context, self._server.wishes.overlays)

    def _position(self, time_: float) -> int:
        return round(min(max(time_ - self._start, 0.0), 1e9) * self._simulation.clock.frequency)

    def _play(self, direction: int) -> None:
        if direction > 0 and self._timeline.at_end:
            self._go(0)
        self._direction = direction
        self._simulation.pacer.restart()

    def _go(self, position: int) -> None:
        """Jump, and stay there while the time line is dragged, or if it was paused before."""
        self._target = max(0, min(position, self._timeline.length))

    def _refuse(self, event: object) -> None:
        self._server.send(Refused(type(event).__name__, "a recorded run cannot be changed"))

    def end(self) -> None:
        """Stop showing it; may be called from signal handlers."""
        self._has_ended = True

    # -- the loop ----------------------------------------------------------------------------

    def run(self) -> None:
        """Show the run until the page or a signal ends it."""
        self._simulation.pacer.restart()
        try:
            while not self._has_ended:
                self.turn()
        finally:
            self._network.give_back()

    def turn(self) -> None:
        """Process requests of the driving page, in small steps."""
        for event in self._server.take_events():
            handler = self._handlers.get(type(event))
            if handler is not None:
                self._parts.handle(handler, event)
        self._network.tend()
        if self._target is not None:
            self._jump()
        elif self._direction > 0:
            self._forward()
        elif self._direction < 0:
            self._backward()
        else:
            self.after_tick()
            self._simulation.context.wait(_IDLE)

    def _jump(self) -> None:
        until = time.monotonic() + _PATIENCE
        target = self._target
        assert target is not None
        while not self._timeline.approach(target):
            if time.monotonic() > until:
                return
        self._target = None
        self._simulation.pacer.restart()
        self.after_tick()

    def _forward(self) -> None:
        if self._timeline.at_end:
            self._play(0)
            return
        self._timeline.forward()
        if self._recorded_timeline is not None:
            self.after_tick()
        self._simulation.pacer.wait()

    def _backward(self) -> None:
        speed = self._simulation.pacer.speed
        ticks = 1e9 if math.isinf(speed) else speed * _FRAME * self._simulation.clock.frequency
        position = max(0, self._timeline.position - max(1, round(min(ticks, self._timeline.length))))
        until = time.monotonic() + _FRAME
        while not self._timeline.approach(position):
            pass
        self.after_tick()
        if position == 0:
            self._play(0)
        while not self._has_ended and (rest := until - time.monotonic()) > 0.0:
            self._simulation.context.wait(rest)
