"""The viewer of MuJoCo, for inspecting the physics.

The viewer is installed by the extra ``studio`` and runs in a browser.
"""

from __future__ import annotations

import importlib
import threading
from typing import TYPE_CHECKING, Any

from morse.system.extras import install

if TYPE_CHECKING:
    from morse.physics.world import World

#: timeout for the viewer to open its port, wall-clock seconds
_PATIENCE = 15.0


class StudioMissingError(OSError):
    """The viewer is not installed; the message contains the command that installs it."""


class Studio:
    """A running viewer of one world.

    Args:
        host: address to which the viewer binds.
        port: TCP port; 0 for the first free one from 8080.

    Raises:
        StudioMissingError: the viewer is not installed.
        OSError: the viewer did not start.
    """

    def __init__(self, world: World, host: str, port: int = 0) -> None:
        launch, server, protocol, app = _modules()
        self._world = world
        sockets: list[Any] = []
        ready = threading.Event()
        bind = server.bind_public_socket

        def bind_here(_host: str, asked: int = 0) -> Any:
            # the viewer listens on all interfaces and has no option for the address
            sockets.append(bind(host, asked))
            ready.set()
            return sockets[0]

        server.bind_public_socket = bind_here
        try:
            self._handle = launch.launch(protocol.ViewerConfig(gfx="web", http_port=port), plugins=[app.App()])
            if not ready.wait(_PATIENCE):
                raise OSError(f"MuJoCo's viewer did not open a port within {_PATIENCE:.0f} s")
        finally:
            server.bind_public_socket = bind
        self.url = f"http://{host}:{sockets[0].getsockname()[1]}/"
        self._handle.set_model(world.model, data=world.data)

    def update(self) -> None:
        """Show the present state, and apply forces and changes that the user makes in the viewer."""
        if self._handle.is_running():
            self._handle.sync(self._world.model, self._world.data)

    def close(self) -> None:
        """Stop the viewer."""
        self._handle.close()


def _modules() -> tuple[Any, Any, Any, Any]:
    try:
        return (
            importlib.import_module("mujoco.studio.launch_web"),
            importlib.import_module("mujoco.studio.web.web_server"),
            importlib.import_module("mujoco.studio.viewer_protocol"),
            importlib.import_module("mujoco.studio.app"),
        )
    except ImportError as error:
        raise StudioMissingError(
            f"--view studio needs MuJoCo's own viewer ({error}); install it with: {install('studio')}"
        ) from None
