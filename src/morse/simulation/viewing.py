"""Connects a running simulation with its live view."""

from __future__ import annotations

import logging
import math
import os
import sys
import time
import webbrowser
from typing import TYPE_CHECKING, Any, Literal, cast

from morse.simulation.view_debug import ViewDebug
from morse.simulation.view_drag import ViewDrag
from morse.simulation.view_overlays import ViewOverlays
from morse.simulation.view_rays import ViewRays
from morse.simulation.view_requests import ViewRequests
from morse.simulation.view_tree import component_tree, keyboard_robots
from morse.viewer import page_messages as page
from morse.viewer.server import ViewServer
from morse.viewer.snapshot import MovingNode, Snapshot
from morse.viewer.view_messages import Appearance, Listening, Pace, Tree, Values

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.simulation.live_view import LiveView
    from morse.simulation.simulation import Simulation

logger = logging.getLogger("morse.viewer")

#: wall-clock seconds between two snapshots, however fast the simulation runs: no screen shows more
_SNAPSHOT_INTERVAL = 1.0 / 125.0
#: the same where nothing waits for the wall clock: what the view takes there, the simulation lacks
_UNPACED_INTERVAL = 1.0 / 30.0
#: ticks that take longer than that, s, are all shown: to show one takes little beside it
_LONG_TICK = 0.01
#: wall-clock seconds between two updates of the values that pages show
_VALUES_INTERVAL = 1.0 / 20.0


def open_view(simulation: Simulation) -> LiveView | None:
    """Start the live view that the options ask for.

    Raises:
        StudioMissingError: MuJoCo's viewer is asked for and not installed.
    """
    if simulation.options.view == "none":
        return None
    if simulation.options.view == "studio":
        from morse.simulation.studio_view import StudioView

        return StudioView(simulation)
    return View(simulation)


def has_display() -> bool:
    """Whether a browser window could be opened here."""
    return sys.platform in ("win32", "darwin") or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


class View:
    """Sends what happens to the pages, and carries out what the driving page asks for."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        options = simulation.options
        self._server = ViewServer(
            simulation.context.network,
            host=options.host,
            port=options.view_port,
            token=options.view_token,
            title=simulation.scene.environment or "MORSE",
        )
        self._layout = -1
        self._shown = self._told = self._ticked = 0.0
        self._listening: str | None = None
        self._requests = ViewRequests(simulation.context, self._server)
        self._rays = ViewRays(simulation.context, self._server)
        self._overlays = ViewOverlays(simulation.context, self._server)
        self._debug = ViewDebug(simulation, self._server)
        self._drag = ViewDrag(simulation.context)
        simulation.context.held_keys = self._server.held_keys
        simulation.context.gamepad = lambda: self._server.gamepad()[0]
        simulation.context.listening_robot = lambda: self._listening
        self._url = self._server.start()
        self._handlers: dict[type[Any], Callable[[Any], None]] = {
            page.Play: lambda _: self._set_paused(False),
            page.Pause: lambda _: self._set_paused(True),
            page.Step: lambda event: simulation.step(event.count) if simulation.paused else None,
            page.Reset: lambda _: simulation.restart(),
            page.SetSpeed: lambda event: simulation.pacer.set_speed(event.factor or math.inf),
            page.Quit: lambda _: simulation.stop(),
            page.ListenTo: self._listen_to,
            page.SetProperty: self._requests.set_property,
            page.CallService: self._requests.call,
            page.CancelService: self._requests.cancel,
            page.Activate: self._requests.activate,
            page.Teleport: self._requests.teleport,
            page.ToggleCapturing: self._requests.toggle_capturing,
            page.Drag: self._drag.hold,
            page.DragEnd: self._drag.release,
        }

    @property
    def url(self) -> str:
        """The address to open in a browser."""
        return self._url

    def announce(self) -> None:
        """The simulation is ready: describe it, say where to look, open a browser."""
        self._describe()
        self._server.send(Tree(component_tree(self._simulation.context)))
        self._overlays.announce()
        self._requests.tell_capturing()
        self._send_listening()
        logger.info("the live view is at %s", self._url)
        if self._simulation.options.open_browser and has_display():
            webbrowser.open(self._url)

    def _describe(self) -> None:
        world = self._simulation.world
        self._layout = world.layout
        moving = [MovingNode(node, cast('Literal["world", "parent"]', frame)) for node, frame in world.moving_nodes()]
        self._server.set_scene(self._simulation.scene, moving)

    def before_tick(self) -> None:
        """Carry out what the driving page asked for."""
        for event in self._server.take_events():
            handler = self._handlers.get(type(event))
            if handler is not None:
                handler(event)
        if not self._simulation.paused:
            self._drag.apply()

    def after_tick(self) -> None:
        """Show what the tick has changed."""
        self._requests.update()
        if not self._server.watched:
            return
        simulation = self._simulation
        world = simulation.world
        if world.layout != self._layout:
            self._describe()
        if world.repainted:
            for obj in sorted(world.repainted, key=lambda o: o.name):
                self._server.send(Appearance(obj.name, obj.visible, obj.node.color))
            world.repainted.clear()
        now = time.monotonic()
        pacer, running = simulation.pacer, not simulation.paused
        quick, self._ticked = now - self._ticked < _LONG_TICK, now
        interval = _UNPACED_INTERVAL if quick and math.isinf(pacer.speed) else _SNAPSHOT_INTERVAL
        # while paused, what is left out here is shown within a tick's time, when the simulation looks again
        if now - self._shown < interval:
            return
        self._shown = now
        clock = simulation.clock
        self._server.publish(
            Snapshot(
                tick=clock.tick,
                time=clock.time,
                layout=world.layout,
                poses=world.poses(),
                status="running" if running else "paused",
                speed=pacer.speed,
                real_time_factor=pacer.real_time_factor if running else 0.0,
            )
        )
        if now - self._told >= _VALUES_INTERVAL:
            self._told = now
            self._send_values()
            self._rays.update()
            self._overlays.update()
            self._debug.update()

    def _send_values(self) -> None:
        context = self._simulation.context
        for name in sorted(self._server.wishes.values):
            component = context.components.get(name) or context.robots.get(name)
            if component is not None:
                self._send_data(name, dict(component.local_data))

    def _send_data(self, name: str, data: dict[str, Any]) -> None:
        now = self._simulation.context.clock.time
        try:
            self._server.send(Values(name, now, data))
        except Exception:  # data of users may hold anything
            self._server.send(Values(name, now, {field: f"{value!r:.200}" for field, value in data.items()}))

    def _set_paused(self, paused: bool) -> None:
        if paused:
            self._simulation.pause()
        else:
            self._simulation.resume()

    def _listen_to(self, event: page.ListenTo) -> None:
        if event.robot is None or event.robot in self._simulation.context.robots:
            self._listening = event.robot
            self._send_listening()

    def _send_listening(self) -> None:
        self._server.send(Listening(keyboard_robots(self._simulation.context), self._listening))

    def report_pace(self, late: float, costliest: str = "", cost: float = 0.0) -> None:
        """Tell the pages how well the simulation keeps up."""
        self._server.send(Pace(self._simulation.clock.strategy.human_repr, late, costliest, cost))

    def viewpoint_changed(self) -> None:
        """The camera of the scene was moved by a service."""
        self._describe()

    def restarted(self) -> None:
        """The simulation started anew: the components are new ones."""
        self._requests.register_all()
        self._requests.tell_capturing()
        self._rays.restarted()
        self._server.send(Tree(component_tree(self._simulation.context)))

    def close(self) -> None:
        """Stop the server."""
        self._server.stop()
