"""Shows pages what cannot be seen: contacts, centres of mass, the space that sensors watch."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from morse.sensors.proximity import Proximity
from morse.viewer.view_messages import Cone, Contacts, MassCentre

if TYPE_CHECKING:
    from morse.core.context import Context
    from morse.viewer.server import ViewServer

#: what a page asks for to see where bodies touch
CONTACTS = "contacts"


class ViewOverlays:
    """Sends overlays to the pages that asked for them."""

    def __init__(self, context: Context, server: ViewServer) -> None:
        self._context = context
        self._server = server
        self._had_contacts = False

    def announce(self) -> None:
        """Tell the pages what does not change: the centres of mass."""
        for name, mass, centre in self._context.world.mass_centres():
            self._server.send(MassCentre(name, mass, centre))

    def update(self) -> None:
        """Send what has changed since the last call."""
        wished = self._server.wishes.overlays
        if CONTACTS in wished or self._had_contacts:
            self._had_contacts = CONTACTS in wished
            points = self._context.world.contact_forces() if self._had_contacts else b""
            self._server.send(Contacts(points))
        for name in sorted(wished):
            component = self._context.components.get(name)
            if isinstance(component, Proximity):
                seen = list(component.local_data["near_objects"])
                self._server.send(Cone(name, component.reach, 2.0 * math.pi, seen))
