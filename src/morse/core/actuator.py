"""The base class of actuators."""

from __future__ import annotations

from morse.core.object import Object


class Actuator(Object):
    """Does something with the data it receives: read ``local_data`` in ``default_action``.

    The last command stays in ``local_data`` and is applied again every tick.
    """

    def action(self) -> None:
        """One tick: pose, streams, modifiers if anything arrived, `default_action`."""
        if not self._active:
            return
        self.position_3d.update(self.bge_object)
        received = False
        for read in self.input_functions:
            received = bool(read(self)) or received
        if received:
            for modifier in self.input_modifiers:
                modifier.modify()
        self.default_action()
