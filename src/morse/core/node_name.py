"""The name of a simulation node."""

from __future__ import annotations

import os
import socket


def node_name() -> str:
    """Return the name of this node: ``--name`` of ``morse run``, else ``$MORSE_NODE``, else the name of the host.

    ``morse run`` writes its option to ``$MORSE_NODE``.
    """
    return os.environ.get("MORSE_NODE") or socket.gethostname()
