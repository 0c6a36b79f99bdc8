"""Plays a recorded run once, and keeps what a page shows of it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from morse.core.declarations import data_fields
from morse.recording.fields.reading import RecordedFields
from morse.simulation.recordings.recorded_timeline import RecordedTimeline
from morse.viewer.feeds.frustums import ViewFrustums
from morse.viewer.feeds.overlays import CONTACTS, ViewOverlays
from morse.viewer.feeds.rays import ViewRays
from morse.viewer.feeds.recorded_pictures import RecordedPicturesFeed
from morse.viewer.feeds.recorded_values import RecordedValuesFeed
from morse.viewer.feeds.recorded_world import cast_wished_rays
from morse.viewer.feeds.tree import component_tree
from morse.viewer.feeds.values import ValuesFeed
from morse.viewer.hub import Wishes
from morse.viewer.looks import appearances, moving_nodes
from morse.viewer.page_export.page_recording import Tape
from morse.viewer.protocol import VERSION
from morse.viewer.view_messages import History, Recordings, Seat, Tree, Welcome

if TYPE_CHECKING:
    from morse.recording.recording import Recording
    from morse.simulation.recordings.timeline import Timeline
    from morse.simulation.simulation import Simulation
    from morse.viewer.live_view import Feed

#: Hz of the poses, between which the page interpolates; of data; of rays and other overlays, and of images
_POSES, _DATA, _SIGHTS = 20.0, 10.0, 5.0
#: maximum number of cameras whose images are kept, if the script shows none
_CAMERAS = 3
#: maximum number of places of the time line
_PLACES = 1000
#: bytes of a tape: of the first minute, and of each further second
_FIRST, _FURTHER = 3_000_000, 45_000


class Span(NamedTuple):
    """The part of a run, in simulated seconds; a length of None is the rest."""

    begin: float = 0.0
    length: float | None = None


def wind(
    simulation: Simulation, timeline: Timeline | RecordedTimeline, recording: Recording, title: str, span: Span
) -> bytes:
    """The tape of a recorded run.

    Args:
        simulation: of the scene of the recording.
        timeline: the run.
        recording: the file of the run.
        title: of the page.
        span: the part that is kept.

    Raises:
        ValueError: the recording ends before the part begins.
    """
    context, world = simulation.context, simulation.world
    frequency, start = simulation.clock.frequency, simulation.clock.time
    recorded_timeline = timeline if isinstance(timeline, RecordedTimeline) else None
    first = round(span.begin * frequency)
    last = timeline.length if span.length is None else min(timeline.length, first + round(span.length * frequency))
    if first >= last:
        raise ValueError(f"the recording ends after {timeline.length / frequency:g} s, before the page begins")
    server: Any = Tape(title)
    server.wishes = _wishes(simulation)
    fields = RecordedFields(recording)
    values = (
        ValuesFeed(context, server)
        if recorded_timeline is None
        else RecordedValuesFeed(context, server, recorded_timeline, fields)
    )
    pictures = RecordedPicturesFeed(context, server, fields, lambda: server.time, looks=recorded_timeline is not None)
    overlays: list[Feed] = [
        ViewRays(context, server),
        ViewOverlays(context, server),
        ViewFrustums(context, server),
        pictures,
    ]

    server.time = begin = start + first / frequency
    end = start + last / frequency
    server.send(Welcome(VERSION, 1, title))
    server.send(Seat(1, [], 1))
    server.send(Recordings([], possible=False))
    places = min(last - first, _PLACES)
    server.send(History([begin + (end - begin) * place / places for place in range(places + 1)], recorded=True))

    layout, components = -1, list[str]()
    for number in range(int((last - first) / frequency * _POSES) + 1):
        position = min(first + round(number * frequency / _POSES), last)
        while not timeline.approach(position):
            pass
        server.time = start + position / frequency
        if world.layout != layout:
            layout = world.layout
            server.set_scene(simulation.scene, moving_nodes(world))
        if components != [*context.robots, *context.components]:
            components = [*context.robots, *context.components]
            server.wishes = _wishes(simulation)
            server.send(Tree(component_tree(context)))
            ViewOverlays(context, server).announce()
            for feed in overlays:
                getattr(feed, "restarted", list)()
        for look in appearances(world):
            server.send(look)
        server.publish(world.poses() if recorded_timeline is None else recorded_timeline.poses())
        if number % round(_POSES / _DATA) == 0:
            values.update()
        if number % round(_POSES / _SIGHTS) == 0:
            if recorded_timeline is not None:
                cast_wished_rays(context, server.wishes.overlays)
            for feed in overlays:
                feed.update()
    tape: bytes = server.to_bytes(begin, end, frequency, _FIRST + int(max(end - begin - 60.0, 0.0) * _FURTHER))
    return tape


def _wishes(simulation: Simulation) -> Wishes:
    """The data of all components, and the rays, overlays and images that the script shows, or else some cameras."""
    context = simulation.context
    display = simulation.scene.settings.view.display
    parts = context.components
    cameras = [name for name, part in parts.items() if "image" in data_fields(type(part))][:_CAMERAS]
    images = [name for name in display.images if name in parts] or cameras
    components = set(parts) if {"rays", "cones"} & set(display.overlays) else {*display.rays, *images}
    contacts = {CONTACTS} & set(display.overlays)
    return Wishes(values=frozenset(parts), overlays=frozenset(components | contacts), images=frozenset(images))
