"""Creates the capture of sensors that act together."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from morse.recording.captures.classes import MESSAGES
from morse.recording.captures.copies import copies_of
from morse.recording.captures.lone import Lone
from morse.recording.captures.poses import groups_of
from morse.recording.captures.sensors import PoseSensors, Scanners
from morse.recording.captures.template import Part, Template

if TYPE_CHECKING:
    from collections.abc import Sequence

    from morse.core.groups.group import Group
    from morse.kernel.recording import NativeRecords
    from morse.recording.captures.capture import Capture
    from morse.recording.recorded_stream import RecordedStream, Single


def capture_of(native: NativeRecords, group: Group | Lone, streams: Sequence[RecordedStream]) -> Capture | None:
    """Return the capture for the measurements of a group.

    Args:
        native: the encoder.
        group: a group, or a sensor that acts alone, that has measured in this tick.
        streams: one stream for each recorded member, in the order of the members.

    Returns:
        None if the streams have to encode each message.
    """
    if not streams:
        return None
    wanted = MESSAGES.get(type(group.members[0]))
    if wanted is None or (isinstance(group, Lone) and group.is_of_data):
        return copies_of(native, group, streams)
    messages = [message for stream in streams if (message := stream.single(wanted)) is not None]
    if len(messages) < len(streams):
        return None
    template = Template(Part(*message) for message in messages)
    rows = [group.row_of(stream.component_instance) for stream in streams]
    make = _poses if wanted == "geometry_msgs/msg/PoseStamped" else _scanners
    return make(native, template, group, rows, messages)


def _poses(
    native: NativeRecords, template: Template, group: Group | Lone, rows: Sequence[int], messages: Sequence[Single]
) -> Capture | None:
    if not native.measures_poses:
        return None
    snapshot = group.poses.snapshot
    made = PoseSensors(native, template, snapshot, rows)
    return made if made.agrees(groups_of(snapshot), [message.data for message in messages]) else None


def _scanners(
    native: NativeRecords, template: Template, group: Group | Lone, rows: Sequence[int], messages: Sequence[Single]
) -> Capture | None:
    scanners: Any = group.members
    first = scanners[0]
    alike = all(one.rays.shape == first.rays.shape and one.laser_range == first.laser_range for one in scanners)
    if not alike or first.rays.reach != first.laser_range or "remission_list" in group.fields:
        return None
    rays = len(first.rays)
    kept = rays - 1 if first.scan_window == 360.0 and rays > 1 else rays
    made = Scanners(native, template, [one.rays for one in scanners], rows, kept, first.laser_range)
    data = made.take(group)
    return made if data is not None and made.agrees([data], [message.data for message in messages]) else None
