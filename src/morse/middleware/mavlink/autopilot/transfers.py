"""The mission protocol: upload, download, clear, and the present item."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.middleware.mavlink.autopilot import items
from morse.middleware.mavlink.autopilot.items import Item, item_of

if TYPE_CHECKING:
    from morse.middleware.mavlink.autopilot.mission import Mission
    from morse.middleware.mavlink.messages import MavlinkMessage
    from morse.middleware.mavlink.vehicle import Vehicle

_MISSION, _ALL = 0, 255
_MOST_ITEMS = 5000
#: simulated time, ns: an item that is late is asked for again; an upload without items ends
_AGAIN, _GIVEN_UP = 500_000_000, 5 * 10**9


class _Upload:
    def __init__(self, sender: tuple[int, int], count: int, stamp: int) -> None:
        self.sender, self.count = sender, count
        self.items: list[Item] = []
        self.heard = self.asked = stamp


class Transfers:
    """Answers the messages of the mission protocol.

    One ground station uploads at a time. A mission replaces the previous one when its last item has arrived.
    """

    def __init__(self, vehicle: Vehicle, mission: Mission) -> None:
        self._vehicle, self._mission = vehicle, mission
        self._upload: _Upload | None = None
        self._stamp = 0

    def take(self, message: MavlinkMessage) -> None:
        """Answer a message."""
        sender = message.get_srcSystem(), message.get_srcComponent()
        kind = message.get_type()
        if kind == "MISSION_SET_CURRENT":
            self._mission.go_on_at(message.seq)
            return
        type_ = getattr(message, "mission_type", _MISSION)
        if type_ != _MISSION and not (kind == "MISSION_CLEAR_ALL" and type_ == _ALL):
            # there are no fences and no rally points
            if kind != "MISSION_ACK":
                self._acknowledge(sender, items.UNSUPPORTED, type_)
        elif kind == "MISSION_COUNT":
            self._begin(sender, message.count)
        elif kind in ("MISSION_ITEM_INT", "MISSION_ITEM"):
            self._item(sender, message)
        elif kind == "MISSION_REQUEST_LIST":
            self._vehicle.send("mission_count", *sender, len(self._mission.items), _MISSION)
        elif kind in ("MISSION_REQUEST_INT", "MISSION_REQUEST"):
            self._send_item(sender, message)
        elif kind == "MISSION_CLEAR_ALL":
            self._upload = None
            self._mission.replace([])
            self._acknowledge(sender, items.ACCEPTED, type_)
            self._mission.tell()
        elif kind == "MISSION_ACK" and self._upload is not None and self._upload.sender == sender and message.type:
            self._upload = None  # the sender has cancelled it

    def tick(self, stamp: int) -> None:
        """Ask again for an item that is late, or end an upload.

        Args:
            stamp: simulated time, ns.
        """
        self._stamp = stamp
        upload = self._upload
        if upload is None:
            return
        if stamp < upload.heard or stamp - upload.heard > _GIVEN_UP:
            self._upload = None
            self._acknowledge(upload.sender, items.CANCELLED)
        elif stamp - upload.asked > _AGAIN:
            self._ask(upload)

    def _acknowledge(self, sender: tuple[int, int], result: int, type_: int = _MISSION) -> None:
        self._vehicle.send("mission_ack", *sender, result, type_)

    def _begin(self, sender: tuple[int, int], count: int) -> None:
        if self._upload is not None and self._upload.sender != sender:
            self._acknowledge(sender, items.DENIED)
        elif count > _MOST_ITEMS:
            self._upload = None
            self._acknowledge(sender, items.NO_SPACE)
        elif count == 0:
            self._upload = None
            self._mission.replace([])
            self._acknowledge(sender, items.ACCEPTED)
        else:
            self._upload = _Upload(sender, count, self._stamp)
            self._ask(self._upload)

    def _ask(self, upload: _Upload) -> None:
        upload.asked = self._stamp
        self._vehicle.send("mission_request_int", *upload.sender, len(upload.items), _MISSION)

    def _item(self, sender: tuple[int, int], message: MavlinkMessage) -> None:
        upload = self._upload
        if upload is None:
            return  # the repetition of the last item, or what is late
        if upload.sender != sender:
            self._acknowledge(sender, items.DENIED)
            return
        upload.heard = self._stamp
        if message.seq != len(upload.items):
            if message.seq > len(upload.items):
                self._ask(upload)
            return
        item = item_of(message)
        if not isinstance(item, Item):
            self._upload = None
            self._acknowledge(sender, item)
            return
        upload.items.append(item)
        if len(upload.items) < upload.count:
            self._ask(upload)
            return
        self._upload = None
        self._mission.replace(upload.items)
        self._acknowledge(sender, items.ACCEPTED)
        self._mission.tell()

    def _send_item(self, sender: tuple[int, int], message: MavlinkMessage) -> None:
        if not 0 <= message.seq < len(self._mission.items):
            self._acknowledge(sender, items.INVALID_SEQUENCE)
            return
        item = self._mission.items[message.seq]
        is_int = message.get_type() == "MISSION_REQUEST_INT"
        x: float = item.x
        y: float = item.y
        if not is_int:
            scale = 1e-4 if item.frame == 1 else 1e-7
            x, y = x * scale, y * scale
        self._vehicle.send(
            "mission_item_int" if is_int else "mission_item", *sender, message.seq, item.frame, item.command,
            int(message.seq == self._mission.current), item.autocontinue, *item.params, x, y, item.z, _MISSION,
        )  # fmt: skip
