"""Connects a running simulation with its live view."""

from __future__ import annotations

import logging
import math
import secrets
import time
import webbrowser
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, Protocol

from morse.core.clients.complaints import Complaints
from morse.core.exceptions import MorseError
from morse.core.observer import Observer
from morse.core.reports.faults import class_name, place, summary
from morse.core.reports.quoting import short
from morse.helpers.air import Air
from morse.viewer import page_messages as page
from morse.viewer.describe import appearances, moving_nodes, pictured
from morse.viewer.display import has_display
from morse.viewer.editor import Editor
from morse.viewer.feeds.components import StatesFeed, ValuesFeed, ViewDebug, component_tree, keyboard_robots
from morse.viewer.feeds.log import LogFeed, RecordingsFeed, printable
from morse.viewer.feeds.sensors import PicturesFeed, SoundsFeed, ViewClouds, ViewFrustums, ViewOverlays, ViewRays
from morse.viewer.notebook import Frame, frame, proxy_token
from morse.viewer.page import PageLeft
from morse.viewer.page_inputs import Commands, Rewinder, ServiceCalls
from morse.viewer.server import ViewServer
from morse.viewer.snapshot import Snapshot
from morse.viewer.view_messages import (
    AirLook,
    AirPart,
    Answer,
    FileMistake,
    Listening,
    Pace,
    Refused,
    SavedFiles,
    Task,
    TaskPoint,
    Tree,
    Viewpoint,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy as np
    from numpy.typing import NDArray

    from morse.core.guard import Guard
    from morse.scene import Image
    from morse.simulation.simulation import Simulation
    from morse.simulation.watching.edits import Edits


# Titles of pages.

#: names of scripts that say nothing: the name of the folder does
_COMMON = ("default", "scene", "main", "__main__")


def title_of(script: str, environment: str) -> str:
    """The name of the project of a scene script, or that of the script; without a script, that of the environment."""
    path = Path(script) if script else Path()
    name = path.absolute().parent.name if path.stem in _COMMON else path.stem
    return name or environment or "MORSE"


class Moving:
    """Applies pointer actions of the page to objects, by the services for clients."""

    def __init__(self, server: ViewServer, services: ServiceCalls) -> None:
        self._server = server
        self._services = services

    def teleport(self, event: page.Teleport) -> bool:
        """Move an object to a pose, at rest; returns whether that was possible."""
        place = (event.node, list(event.position), list(event.quaternion))
        if self._services.attempt(event.request, lambda: self._services.run("simulation", "set_object_pose", *place)):
            self._server.send(Answer(event.request, True))
            return True
        return False

    def drag(self, event: page.Drag) -> None:
        """Start pulling, or move the target."""
        try:
            self._services.run("simulation", "pull", event.node, list(event.anchor), list(event.target))
        except MorseError as error:
            self._server.send(Refused("drag", str(error)))

    def let_go(self, _event: page.DragEnd | None = None) -> None:
        """Stop pulling."""
        self._services.run("simulation", "let_go")


class EditsFeed:
    """Sends the state of the files that were saved."""

    def __init__(self, edits: Edits, server: ViewServer) -> None:
        self._edits = edits
        self._server = server
        self._last_message = SavedFiles([], [])

    def update(self) -> None:
        """Send it if it has changed."""
        mistakes = [
            FileMistake(PurePath(one.path).name, one.line, printable(one.text)) for one in self._edits.mistakes.values()
        ]
        message = SavedFiles(mistakes, [PurePath(path).name for path in self._edits.waiting])
        if message != self._last_message:
            self._last_message = message
            self._server.send(message)


class AirFeed:
    """Sends how the air looks, while it is not clear."""

    def __init__(self, air: Air, server: ViewServer) -> None:
        self._air = air
        self._server = server
        self._last_message = AirLook([], (0.0, 0.0, 0.0), 0.0, 0.0)

    def update(self) -> None:
        """Send it if it has changed."""
        air = self._air
        parts = [AirPart(**{**look._asdict(), "corners": list(look.corners)}) for look in air.looks]
        wind = air.wind if parts else (0.0, 0.0, 0.0)
        message = AirLook(parts, wind, float(air.wet), float(air.snow_cover))
        if message != self._last_message:
            self._last_message = message
            self._server.send(message)


logger = logging.getLogger("morse.viewer")

#: minimum wall-clock seconds between two snapshots: no screen shows more
_SNAPSHOT_INTERVAL = 1.0 / 125.0
#: the same for a simulation that runs as fast as possible: the view must not slow its ticks
_UNPACED_INTERVAL = 1.0 / 20.0
#: ticks that take longer than this, s, are all shown: compared with them, a snapshot is cheap
_LONG_TICK = 0.01
#: time that a tick takes for the requests of pages, s; the rest waits for the next tick
_LONGEST = 0.005
#: wall-clock seconds between two updates of the values that pages show
_VALUES_INTERVAL = 1.0 / 20.0
#: the same between two attempts to show a world that cannot be shown
_WORLD_INTERVAL = 1.0


class Feed(Protocol):
    """Data that are sent to pages in addition to the poses."""

    def update(self) -> None:
        """Send the changes since the last call."""


class Parts:
    """Calls the parts of a view. One that raises an error is switched off, and named in the log and on the pages."""

    def __init__(self, guard: Guard, server: ViewServer) -> None:
        self._guard, self._server = guard, server
        self._complaints = Complaints(logger)
        #: kept, so that no other part gets the number of one of them
        self._off: dict[int, object] = {}

    def run(self, part: object, call: Callable[[], object]) -> None:
        """Call a function that belongs to a part, unless the part is switched off."""
        if id(part) not in self._off:
            self._guard.run(call, lambda error: self._switch_off(part, error))

    def _switch_off(self, part: object, error: BaseException) -> None:
        self._off[id(part)] = part
        who = f"the part {class_name(type(part))} of the live view"
        self._server.send(Refused("view", f"{who} has failed and is switched off: {short(summary(error), 500)}"))
        self._guard.failed(part, who, "is switched off", error)

    def complain(self, what: str, error: BaseException) -> None:
        """Name what has failed, and may succeed later."""
        self._complaints.log(logging.ERROR, what, f"the live view: {what}: {summary(error)}\n{place(error)}".rstrip())
        self._server.send(Refused("view", f"{what}: {short(summary(error), 500)}"))

    def handle(self, handler: Callable[[Any], object], event: page.ViewEvent) -> None:
        """Execute a request of a page; if that fails, the page gets an answer, and the view continues."""
        self._guard.run(lambda: handler(event), lambda error: self._refuse(event, error))

    def _refuse(self, event: page.ViewEvent, error: BaseException) -> None:
        what, text = str(type(event).__struct_config__.tag), summary(error)
        line = f"the live view: the request {what} has failed: {text}\n{place(error)}".rstrip()
        self._complaints.log(logging.ERROR, what, line)
        request = getattr(event, "request", None)
        error_text = short(text, 500)
        self._server.send(
            Refused(what, f"{what} has failed: {error_text}")
            if request is None
            else Answer(request, False, error=error_text)
        )


class View(Observer):
    """Sends events to the pages, and executes the requests of the driving page.

    A request or a part of the view that fails is dropped and named; the server and all other parts continue.

    Attributes:
        changeable: whether pages may change the simulation and record the run.
    """

    changeable = True

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        options = simulation.options
        context = simulation.context
        # other users of this machine reach the port, too: they may not run code as this one
        secret = secrets.token_urlsafe(16) if options.edit_script else None
        self._server = server = ViewServer(
            context.network,
            host=options.host,
            port=options.view_port,
            token=options.view_token or proxy_token() or secret,
            title=title_of(options.script, simulation.scene.environment),
            origins=options.view_origins,
        )
        self._parts = Parts(context.guard, server)
        self._layout = -1
        self._last_frame = self._last_pace = self._last_tick = self._next_world = 0.0
        self._listening: str | None = None
        self._told_names: list[str] = []
        self._known_names: set[str] = set()
        self._images: dict[str, Image | None] = {}
        self._commands = Commands(context)
        self._services = ServiceCalls(context, server, self._commands)
        self._moving = Moving(server, self._services)
        self._editor = Editor(simulation, server, self._services)
        self._history = Rewinder(simulation, lambda: simulation.clock.time, server)
        self._states = StatesFeed(context, server)
        self._rays = ViewRays(context, server)
        self._clouds = ViewClouds(context, server)
        self._frustums = ViewFrustums(context, server)
        self._pictures: Feed = PicturesFeed(context, server)
        self._sounds = SoundsFeed(context, server)
        self._feeds: list[Feed] = [
            ValuesFeed(context, server),
            self._states,
            self._rays,
            self._clouds,
            ViewOverlays(context, server),
            ViewDebug(simulation, server),
            self._frustums,
            self._sounds,
            EditsFeed(simulation.edits, server),
            AirFeed(context.server(Air), server),
            RecordingsFeed(simulation, server, possible=self.changeable),
            *([self._editor] if self.changeable else []),
        ]
        self._log = LogFeed(context, server)
        try:
            self._url = server.start()
        except OSError:
            self._log.close()
            raise
        self._handlers: dict[type, Callable[[Any], object]] = {
            page.Play: lambda _: self._set_paused(False),
            page.Pause: lambda _: self._set_paused(True),
            page.Step: lambda event: simulation.request_steps(event.count) if simulation.paused else None,
            page.Reset: lambda _: simulation.start_anew(),
            page.SetSpeed: lambda event: simulation.pacer.set_speed(event.factor or math.inf),
            page.Rewind: lambda event: self._history.rewind(event.time),
            page.StepBack: lambda _: self._history.step_back(),
            page.Quit: lambda _: self._quit(),
            page.ListenTo: self._listen_to,
            page.SetProperty: self._editor.set_property if self.changeable else self._services.set_property,
            page.Command: self._services.command,
            page.CallService: self._services.call,
            page.CancelService: self._services.cancel,
            page.Activate: self._services.activate,
            page.ToggleCapturing: self._services.toggle_capturing,
            page.Teleport: self._teleport,
            page.Drag: self._moving.drag,
            page.DragEnd: self._moving.let_go,
            page.ListModels: self._editor.list_models,
            page.AddModel: self._editor.add,
            page.BeginUpload: self._editor.uploads.begin,
            page.UploadPart: self._editor.uploads.take,
            page.ExamineUpload: self._editor.uploads.examine,
            page.DeleteObject: self._editor.delete,
            page.ScaleObject: self._editor.scale,
            page.DuplicateObject: self._editor.duplicate,
            page.ListSettings: self._editor.list_settings,
            page.Configure: self._editor.configure,
            page.UndoChange: self._editor.undo,
            page.RedoChange: self._editor.redo,
            page.SaveScene: self._editor.save,
            page.ShowScript: self._editor.show_script,
            page.ChangeScript: self._editor.change_script,
            PageLeft: self._services.forget,
        }

    def __repr__(self) -> str:
        return f"<View at {self._url}>"

    @property
    def url(self) -> str:
        """The address for a browser."""
        return self._url

    @property
    def address(self) -> tuple[int, str | None]:
        """TCP port, and the token that a page must present, if there is one."""
        return self._server.address

    @property
    def drawn(self) -> bool:
        """Whether any page has drawn the world."""
        return self._server.drawn

    def show(self, height: int) -> Frame:
        """The page in a frame, for a notebook; see `morse.viewer.notebook.frame`."""
        return frame(self._url, height)

    def show_task(
        self, title: str, text: str, points: Sequence[tuple[str, bool, str]] = (), *, is_checked: bool = False
    ) -> None:
        """Show on all pages what is to be done, and what has been checked of it so far; replaces the task before.

        Args:
            title: a few words.
            text: paragraphs, lists and code in Markdown.
            points: what is expected, whether it is so, and what might help.
            is_checked: whether the check has ended.
        """
        shown = [TaskPoint(printable(what), is_right, printable(hint)) for what, is_right, hint in points]
        self._server.send(Task(printable(title), text, shown, is_checked))

    def announce(self) -> None:
        """The simulation is ready: describe it, log the address, open a browser."""
        self._describe()
        self._tell_components()
        ViewOverlays(self._simulation.context, self._server).announce()
        self._states.tell_capturing()
        self._send_listening()
        logger.info("the live view is at %s", self._url)
        if self._simulation.options.open_browser and has_display():
            webbrowser.open(self._url)

    def _describe(self) -> None:
        world = self._simulation.world
        self._layout = world.layout
        self._server.set_scene(self._simulation.scene, moving_nodes(world))

    def before_tick(self) -> None:
        """Execute the requests of the driving page."""
        server = self._server
        self._parts.run(self._editor, self._editor.change_again)
        if events := server.take_events():
            self._handle(events)
        self._simulation.set_controls(server.held_keys(), tuple(server.gamepad()[0]), self._listening)

    def _handle(self, events: Sequence[page.ViewEvent]) -> None:
        """Execute requests, for a few milliseconds."""
        begin = time.perf_counter()
        for number, event in enumerate(events, 1):
            handler = self._handlers.get(type(event))
            if handler is not None:
                self._parts.handle(handler, event)
            if time.perf_counter() - begin > _LONGEST:
                self._server.put_back(events[number:])
                return

    def after_tick(self) -> None:
        """Show the changes of the tick."""
        run = self._parts.run
        run(self._services, self._services.update)
        run(self._log, self._log.update)
        if not self._server.watched:
            return
        simulation = self._simulation
        pacer, is_running = simulation.pacer, not self._is_paused()
        now = time.monotonic()
        quick, self._last_tick = now - self._last_tick < _LONG_TICK, now
        interval = _UNPACED_INTERVAL if quick and pacer.speed == math.inf else _SNAPSHOT_INTERVAL
        # while paused, changes that are omitted here are shown within the time of a tick
        is_due = now - self._last_frame >= interval
        if is_due or not is_running:
            run(self._history, lambda: self._history.keep(paused=not is_running))
        if not is_due:
            return
        self._last_frame = now
        if now >= self._next_world:
            self._simulation.context.guard.run(lambda: self._show_world(is_running=is_running), self._lack_world)
        # every image is sent: the camera determines the rate
        run(self._pictures, self._pictures.update)
        if now - self._last_pace >= _VALUES_INTERVAL:
            self._last_pace = now
            for feed in self._feeds:
                run(feed, feed.update)

    def _show_world(self, *, is_running: bool) -> None:
        simulation = self._simulation
        world, clock = simulation.world, simulation.clock
        if world.layout != self._layout:
            self._describe()
        if world.repainted:
            if pictured(world, self._images):
                self._describe()
            for look in appearances(world):
                self._server.send(look)
        self._server.publish(
            Snapshot(
                tick=clock.tick,
                time=self._time(),
                layout=world.layout,
                poses=self._poses(),
                status="running" if is_running else "paused",
                speed=simulation.pacer.speed,
                real_time_factor=self._factor() if is_running else 0.0,
            )
        )

    def _lack_world(self, error: BaseException) -> None:
        """The world cannot be shown, perhaps because of an object that has just been spawned: try again later."""
        self._layout, self._next_world = -1, time.monotonic() + _WORLD_INTERVAL
        self._parts.complain("the world cannot be shown at present", error)

    def _is_paused(self) -> bool:
        return self._simulation.paused

    def _time(self) -> float:
        return self._simulation.clock.time

    def _factor(self) -> float:
        """Simulated seconds per wall-clock second."""
        return self._simulation.pacer.real_time_factor

    def _poses(self) -> NDArray[np.float32]:
        return self._simulation.world.poses()

    def _set_paused(self, is_paused: bool) -> None:
        if is_paused:
            self._simulation.pause()
        else:
            self._simulation.resume()

    def _quit(self) -> None:
        logger.info("a page of the live view has ended the simulation")
        self._simulation.stop()

    def _teleport(self, event: page.Teleport) -> None:
        if self._moving.teleport(event):
            self._editor.moved(event)

    def _listen_to(self, event: page.ListenTo) -> None:
        if event.robot is None or event.robot in self._simulation.context.robots:
            self._listening = event.robot
            self._send_listening()

    def _send_listening(self) -> None:
        self._server.send(Listening(keyboard_robots(self._simulation.context), self._listening))

    def report_pace(self, late: float, cause: str = "") -> None:
        """Tell the pages how well the simulation keeps up."""
        self._server.send(Pace(self._simulation.clock.strategy.human_repr, late, cause))

    def viewpoint_changed(self) -> None:
        """A service has moved the camera of the scene."""
        view = self._simulation.scene.settings.view
        self._server.send(Viewpoint(view.camera_location, view.camera_rotation, view.camera_clip))

    def restarted(self) -> None:
        """Describe the components again, because the simulation has restarted."""
        self._parts.run(self._history, self._history.restarted)
        self._parts.run(self._editor, self._editor.restarted)
        self._connect_components()
        self._parts.run(self._states, self._tell_components)

    def edited(self) -> None:
        """A model or the class of a component was replaced: the saved states are no longer valid."""
        self._parts.run(self._history, self._history.restarted)
        # fields may have changed, and the mistake that a page shows is mended
        self._told_names.clear()

    def rearranged(self) -> None:
        """Components or objects were added or removed, or another state was restored."""
        self._connect_components()
        if self._names() != self._told_names:
            self._parts.run(self._states, self._tell_components)

    def _connect_components(self) -> None:
        run = self._parts.run
        run(self._services, self._services.register_all)
        run(self._states, self._states.rearranged)
        for part in (self._commands, self._rays, self._clouds, self._frustums, self._sounds):
            run(part, part.restarted)

    def _tell_components(self) -> None:
        self._told_names = self._names()
        gone, self._known_names = self._known_names.difference(self._told_names), set(self._told_names)
        if gone:
            self._server.forget(gone)
        self._states.restarted()
        self._server.send(Tree(component_tree(self._simulation.context)))

    def _names(self) -> list[str]:
        return [*self._simulation.context.robots, *self._simulation.context.components]

    def close(self) -> None:
        """Stop the server."""
        self._parts.run(self._editor, self._editor.close)
        self._parts.run(self._log, self._log.update)
        self._log.close()
        self._server.stop()
