"""Sends overlays to pages: contacts, centres of mass, fields of view of sensors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from morse.core.sensor import Sensor
from morse.viewer.view_messages import Cone, Contacts, MassCentre

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.core.watched_space import WatchedSpace
    from morse.viewer.server import ViewServer

#: the name by which a page requests contacts
CONTACTS = "contacts"


class ViewOverlays:
    """Sends overlays to the pages that have requested them."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._had_contacts = False
        self._spaces: dict[str, WatchedSpace] = {}

    def announce(self) -> None:
        """Send the overlays that do not change: the centres of mass."""
        for name, mass, centre in self._context.world.mass_centres():
            self._server.send(MassCentre(name, mass, centre))

    def update(self) -> None:
        """Send the changes since the last call."""
        wishes = self._server.wishes.overlays
        if CONTACTS in wishes or self._had_contacts:
            self._had_contacts = CONTACTS in wishes
            points = self._context.world.contact_forces() if self._had_contacts else b""
            self._server.send(Contacts(points))
        for name in sorted(wishes):
            component = self._context.components.get(name)
            space = component.watched_space() if isinstance(component, Sensor) else None
            if space is not None and self._spaces.get(name) != space:
                self._spaces[name] = space
                self._server.send(Cone(name, space.reach, space.angle, list(space.seen)))
