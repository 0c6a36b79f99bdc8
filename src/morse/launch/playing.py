"""``morse replay``: shows a recorded run in the live view."""

from __future__ import annotations

import contextlib
import signal
from dataclasses import replace
from typing import TYPE_CHECKING

from morse.launch.ending_signals import ending_signals
from morse.launch.load import resolve
from morse.launch.recorded_run import guard, inputs_of, shown_scene, timeline_in
from morse.recording.recorder import FIRST_SHOWN
from morse.simulation.simulation import Simulation
from morse.viewer.replay_view import ReplayView

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from morse.recording.recording import Recording
    from morse.scene import Scene


@contextlib.contextmanager
def playing(
    recording: Recording,
    scene: str = "",
    say: Callable[[str], object] = print,
    *,
    trust: bool = False,
    projects: Sequence[str] = (),
    port: int = 8765,
    browser: bool = True,
) -> Iterator[ReplayView]:
    """The view of a recorded run, for `play`.

    Args:
        recording: a recording of a run.
        scene: path of a scene script; empty for the scene that the recording describes, or else its script.
        say: callback for messages to the user.
        trust, projects: see `morse.launch.recorded_run.options_of`.
        port: port of the page; 0 for any free port.
        browser: whether to open the page.

    Raises:
        RecordingError: the recording is not sufficient.
        MorseError: the scene cannot be loaded, or does not match the inputs.
        OSError: the server of the page cannot be started.
    """
    if recording.format < FIRST_SHOWN:
        raise recording.of_another_format()
    inputs = inputs_of(recording, lenient=True)
    with contextlib.ExitStack() as stack:
        scene_view = shown_scene(recording, inputs, scene, trust, stack, say, projects)
        options = replace(scene_view.options, view="web", view_port=port, open_browser=browser, speed=1.0)
        _close(scene_view.scene)
        resolve(scene_view.scene)
        simulation = stack.enter_context(Simulation(scene_view.scene, options))
        simulation.load()
        guard(simulation, described=scene_view.is_described, trust=trust)
        timeline = timeline_in(simulation, recording, inputs, say, described=scene_view.is_described)
        view = ReplayView(simulation, timeline, recording)
        simulation.view = view
        simulation.observers.append(view)
        yield view


def play(view: ReplayView) -> None:
    """Log the address of the page, and play until the page, Ctrl+C or a termination signal ends it."""
    before = {number: signal.signal(number, lambda *_: view.end()) for number in ending_signals()}
    try:
        view.announce()
        view.run()
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _close(scene: Scene) -> None:
    """Remove the streams and services, so that only the page is served."""
    for component in scene.components:
        component.streams.clear()
        component.managers.clear()
        component.overlays.clear()
    scene.manager_options.clear()
    scene.simulation_managers.clear()
