"""The name of a simulation node."""

from __future__ import annotations

import socket

from morse.system import variables


def node_name() -> str:
    """Return the name of this node: ``--name`` of ``morse run``, else ``$MORSE_NODE``, else the name of the host.

    ``morse run`` writes its option to ``$MORSE_NODE``.
    """
    return variables.text("MORSE_NODE") or socket.gethostname()
