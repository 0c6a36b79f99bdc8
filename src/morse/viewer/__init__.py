"""The live view: a page in the browser that shows and controls the simulation."""

from __future__ import annotations

__all__ = ["MovingNode", "Snapshot", "ViewServer"]


def __getattr__(name: str) -> object:
    # the command line only needs the names of this package: the server is imported on first use
    if name == "ViewServer":
        from morse.viewer.server import ViewServer

        return ViewServer
    if name in ("MovingNode", "Snapshot"):
        from morse.viewer import snapshot

        return getattr(snapshot, name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")
