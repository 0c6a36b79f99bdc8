"""A page of a recorded run."""

from __future__ import annotations

import contextlib
from typing import TYPE_CHECKING

from morse.cli.messages import say

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from morse.recording.recording import Recording


def page(
    recording: Recording,
    path: Path,
    span: tuple[float, float | None],
    scene: str,
    *,
    trust: bool,
    projects: Sequence[str] = (),
) -> None:
    """Write a page that plays a recorded run anywhere, without a server.

    Args:
        recording: recording of the run.
        path: of the page.
        span: seconds before the run that is shown, and its length; None for the rest.
        scene, trust, projects: see `morse.launch.timelines.timeline_of`.

    Raises:
        MorseError: the run cannot be simulated again.
        OSError: the page cannot be written.
        ValueError: the recording ends before the run that is shown.
    """
    from morse.launch.timelines import timeline_of
    from morse.viewer.page_export.html import page_of
    from morse.viewer.page_export.playback import Span, wind
    from morse.viewer.titles import title_of

    with contextlib.ExitStack() as stack:
        simulation, timeline = timeline_of(recording, stack, scene, say, trust=trust, projects=projects)
        title = title_of(recording.facts.get("script", ""), simulation.scene.environment)
        text = page_of(wind(simulation, timeline, recording, title, Span(*span)), title)
    path.write_text(text, encoding="utf-8", newline="\n")
    say(f"{path}: {len(text.encode()) / 1e6:.1f} MB. Open it in a browser; it needs nothing else.")
