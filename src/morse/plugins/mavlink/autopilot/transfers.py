"""The mission protocol: upload, download, clear, and the present item."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.plugins.mavlink.autopilot import items
from morse.plugins.mavlink.autopilot.items import Item

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.plugins.mavlink.autopilot.failsafe import Fence
    from morse.plugins.mavlink.autopilot.mission import Mission
    from morse.plugins.mavlink.framing import MavlinkMessage
    from morse.plugins.mavlink.vehicle import Vehicle

#: MAV_MISSION_TYPE
MISSION, FENCE, _ALL = 0, 1, 255
_MOST_ITEMS = 5000
#: ``current`` of an item that is not part of a mission, as ArduPilot reads it: go there at once, or to its height
_GO, _CLIMB = 2, 3
#: simulated time, ns: an item that is late is asked for again; an upload without items ends
_AGAIN, _GIVEN_UP = 500_000_000, 5 * 10**9


class _Upload:
    def __init__(self, sender: tuple[int, int], type_: int, count: int, stamp: int) -> None:
        self.sender, self.type, self.count = sender, type_, count
        self.items: list[Item] = []
        self.heard = self.asked = stamp


class Transfers:
    """Answers the messages of the mission protocol.

    One ground station uploads at a time. A plan replaces the previous one when its last item has arrived. There are no
    rally points: their list is empty, and an upload is refused.
    """

    def __init__(self, vehicle: Vehicle, mission: Mission, fence: Fence) -> None:
        self._vehicle, self._mission = vehicle, mission
        self._plans: Mapping[int, Mission | Fence] = {MISSION: mission, FENCE: fence}
        self._upload: _Upload | None = None
        #: the last upload that has ended well: sender, type, count
        self._ended: tuple[tuple[int, int], int, int] | None = None
        self._stamp = 0

    def take(self, message: MavlinkMessage) -> None:
        """Answer a message."""
        sender = message.get_srcSystem(), message.get_srcComponent()
        kind = message.get_type()
        if kind == "MISSION_SET_CURRENT":
            self._mission.go_on_at(message.seq)
            return
        type_ = getattr(message, "mission_type", MISSION)
        plan = self._plans.get(type_)
        if kind == "MISSION_REQUEST_LIST":
            self._vehicle.send("mission_count", *sender, 0 if plan is None else len(plan.items), type_)
        elif plan is None and not (kind == "MISSION_CLEAR_ALL" and type_ == _ALL):
            if kind != "MISSION_ACK":
                self._acknowledge(sender, items.UNSUPPORTED, type_)
        elif kind == "MISSION_COUNT":
            self._begin(sender, type_, message.count)
        elif kind in ("MISSION_ITEM_INT", "MISSION_ITEM"):
            self._item(sender, message)
        elif kind in ("MISSION_REQUEST_INT", "MISSION_REQUEST") and plan is not None:
            self._send_item(sender, message, plan, type_)
        elif kind == "MISSION_CLEAR_ALL":
            self._upload = self._ended = None
            for one in self._plans.values() if plan is None else (plan,):
                one.replace([])
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
            self._acknowledge(upload.sender, items.CANCELLED, upload.type)
        elif stamp - upload.asked > _AGAIN:
            self._ask(upload)

    def _acknowledge(self, sender: tuple[int, int], result: int, type_: int) -> None:
        self._vehicle.send("mission_ack", *sender, result, type_)

    def _begin(self, sender: tuple[int, int], type_: int, count: int) -> None:
        self._ended = None
        if self._upload is not None and self._upload.sender != sender:
            self._acknowledge(sender, items.DENIED, type_)
        elif count > _MOST_ITEMS:
            self._upload = None
            self._acknowledge(sender, items.NO_SPACE, type_)
        elif count == 0:
            self._upload = None
            self._acknowledge(sender, self._plans[type_].replace([]), type_)
        else:
            self._upload = _Upload(sender, type_, count, self._stamp)
            self._ask(self._upload)

    def _ask(self, upload: _Upload) -> None:
        upload.asked = self._stamp
        self._vehicle.send("mission_request_int", *upload.sender, len(upload.items), upload.type)

    def _item(self, sender: tuple[int, int], message: MavlinkMessage) -> None:
        upload = self._upload
        if message.current in (_GO, _CLIMB):
            self._acknowledge(sender, self._go_to(message), MISSION)
            return
        type_ = getattr(message, "mission_type", MISSION)
        if upload is None:
            if (sender, type_, message.seq + 1) == self._ended:
                # the sender repeats the last item: the answer was lost
                self._acknowledge(sender, items.ACCEPTED, type_)
            return
        if upload.sender != sender or upload.type != type_:
            self._acknowledge(sender, items.DENIED, type_)
            return
        upload.heard = self._stamp
        if message.seq != len(upload.items):
            if message.seq > len(upload.items):
                self._ask(upload)
            return
        plan = self._plans[upload.type]
        item = plan.item_of(message)
        if not isinstance(item, Item):
            self._upload = None
            self._acknowledge(sender, item, upload.type)
            return
        upload.items.append(item)
        if len(upload.items) < upload.count:
            self._ask(upload)
            return
        self._upload, self._ended = None, (sender, upload.type, upload.count)
        self._acknowledge(sender, plan.replace(upload.items), upload.type)
        self._mission.tell()

    def _go_to(self, message: MavlinkMessage) -> int:
        item = self._mission.item_of(message)
        if not isinstance(item, Item):
            return item
        return self._mission.go_to(item, only_height=message.current == _CLIMB)

    def _send_item(self, sender: tuple[int, int], message: MavlinkMessage, plan: Mission | Fence, type_: int) -> None:
        if not 0 <= message.seq < len(plan.items):
            self._acknowledge(sender, items.INVALID_SEQUENCE, type_)
            return
        item = plan.items[message.seq]
        is_int = message.get_type() == "MISSION_REQUEST_INT"
        x: float = item.x
        y: float = item.y
        if not is_int:
            scale = 1e-4 if item.frame == 1 else 1e-7
            x, y = x * scale, y * scale
        self._vehicle.send(
            "mission_item_int" if is_int else "mission_item", *sender, message.seq, item.frame, item.command,
            int(plan is self._mission and message.seq == self._mission.current), item.autocontinue, *item.params, x, y,
            item.z, type_,
        )  # fmt: skip
