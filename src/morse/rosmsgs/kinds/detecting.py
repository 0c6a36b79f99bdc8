"""Detections."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.rosmsgs.json_text import as_json
from morse.rosmsgs.outlets import Outlet
from morse.rosmsgs.parts import header, quaternion, xyz
from morse.rosmsgs.table import TopicTable, topics

if TYPE_CHECKING:
    from morse.core.kinds import BoundKind, Message
    from morse.core.values import RosMessage
    from morse.rosmsgs.table import Carrier

#: constants of visualization_msgs/Marker
_CUBE, _TEXT, _ADD, _DELETE_ALL = 1, 9, 0, 3
#: size of an object with unknown size, m
_SIZE = (0.3, 0.3, 0.3)
_GREEN = {"r": 0.2, "g": 0.9, "b": 0.3, "a": 0.5}
_WHITE = {"r": 1.0, "g": 1.0, "b": 1.0, "a": 1.0}


class DetectingKinds(TopicTable):
    """The kind detections."""

    @topics("detections")
    def detections(self, stream: Carrier, bound: BoundKind) -> list[Outlet]:
        """Boxes with names, or JSON if the backend does not have vision_msgs; also markers for viewers."""
        frame = "optical" if getattr(bound.component, "relative", False) else "world"
        text = Outlet("std_msgs/msg/String", lambda m, f: {"data": as_json(list(m.records))})
        return [
            Outlet("vision_msgs/msg/Detection3DArray", _detections, frame=frame, instead=text),
            Outlet("visualization_msgs/msg/MarkerArray", _markers, "markers", frame=frame, or_none=True),
        ]


def _detections(message: Message, frame: str) -> RosMessage:
    head = header(message, frame)
    return {"header": head, "detections": [_detection(head, record) for record in message.records]}


def _detection(head: RosMessage, record: RosMessage) -> RosMessage:
    pose = _pose(record)
    hypothesis = {"class_id": str(record.get("label", "")), "score": float(record.get("score", 1.0))}
    return {
        "header": head,
        "results": [{"hypothesis": hypothesis, "pose": {"pose": pose}}],
        "bbox": {"center": pose, "size": xyz(record.get("size"))},
        "id": str(record.get("id", "")),
    }


def _pose(record: RosMessage) -> RosMessage:
    return {"position": xyz(record.get("position")), "orientation": quaternion(record.get("orientation"))}


def _markers(message: Message, frame: str) -> RosMessage:
    # removes the markers of objects that are no longer visible
    markers: list[RosMessage] = [{"header": header(message, frame), "action": _DELETE_ALL}]
    for number, record in enumerate(message.records):
        size = record.get("size") or _SIZE
        common = {"header": header(message, frame), "id": number, "action": _ADD, "pose": _pose(record)}
        markers.append({**common, "ns": "boxes", "type": _CUBE, "scale": xyz(size), "color": _GREEN})
        text = {"ns": "names", "type": _TEXT, "scale": {"z": 0.2}, "color": _WHITE, "text": str(record.get("id", ""))}
        markers.append({**common, **text})
    return {"markers": markers}
