"""What the command line asks of a run, besides the scene itself."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class RunOptions:
    """Options of ``morse run``.

    Attributes:
        script: path of the scene script (or of a ``.blend`` environment); empty for a scene that is there already.
        arguments: become ``sys.argv[1:]`` of the script.
        source_paths: put first on ``sys.path`` (``<env>/src``).
        resource_paths: searched for models before ``MORSE_RESOURCE_PATH`` (``<env>/data``).
        node_name: name of this simulation node.
        sockets: open the middlewares that the scene names; the socket is always among them.
        interfaces: middlewares to which everything is connected, besides what the scene says.
        view: ``none``, ``web`` or ``studio``.
        host: address that every server binds to.
        view_port: TCP port of the live view; the next free one is taken if it is in use.
        view_token: what a page has to show when it comes from another host.
        open_browser: open the live view if there is a display.
        speed: wall-clock factor; ``inf`` for as fast as possible; None for what the scene says.
        duration: stop after that many simulated seconds.
        seed: of all random numbers; None for what the scene says.
        profile: measure what takes the time.
        watch: follow models and components that are saved while the simulation runs.
        strict: an unknown or ill-typed field in a message is an error.
        record: path of the file in which the run is recorded; None for no recording.
        record_only: full names of the sensors that are recorded; empty for all.
    """

    script: str = ""
    arguments: list[str] = field(default_factory=list)
    source_paths: list[str] = field(default_factory=list)
    resource_paths: list[str] = field(default_factory=list)
    node_name: str | None = None
    sockets: bool = True
    interfaces: list[str] = field(default_factory=list)
    view: str = "web"
    host: str = "127.0.0.1"
    view_port: int = 8765
    view_token: str | None = None
    open_browser: bool = True
    speed: float | None = None
    duration: float | None = None
    seed: int | None = None
    profile: bool = False
    watch: bool = False
    strict: bool = False
    record: str | None = None
    record_only: list[str] = field(default_factory=list)
