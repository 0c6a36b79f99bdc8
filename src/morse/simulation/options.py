"""The options of a run, besides the scene itself."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(slots=True)
class RunOptions:
    """Options of ``morse run``.

    Attributes:
        script: path of the scene script (or of a ``.blend`` environment); empty if the scene is already loaded.
        arguments: ``sys.argv[1:]`` of the script.
        source_paths: directories that come first on ``sys.path`` (``<env>/src``).
        resource_paths: directories that are searched for models before ``MORSE_RESOURCE_PATH`` (``<env>/data``).
        node_name: name of this simulation node.
        sockets: whether to open the middlewares of the scene, always including the socket.
        interfaces: middlewares to which all components are connected, in addition to those of the scene.
        view: ``none``, ``web`` or ``studio``.
        host: address that every server binds to.
        view_port: TCP port of the live view; if it is in use, the next free port is used.
        view_token: token that a page from another host has to send.
        view_origins: origins of other web pages that may embed and control the live view.
        edit_script: whether the page that drives may replace the script, so that it can run any code.
        open_browser: whether to open the live view in a browser if there is a display.
        speed: simulated seconds per wall-clock second; ``inf`` for as fast as possible; None for the value of the
            scene.
        duration: stop after that many simulated seconds.
        ticks: stop after that many ticks; None for ``duration``.
        seed: seed of all random numbers; None for the value of the scene.
        profile: whether to measure the time of each phase and component.
        watch: whether to reload models and components that are saved while the simulation runs.
        verbose: whether the summary lists all services.
        strict: whether an unknown or ill-typed field in a message is an error.
        record: path of the file in which the run is recorded; None for no recording.
        keep_last: simulated seconds before a failure that are kept, to be simulated again; 0 for none.
        record_only: full names of the sensors that are recorded; None for all, empty for only inputs and the log.
        cameras_on: where images are rendered, see `morse.scene.image_workers`; None for the value of the scene.
        keep_going: whether a part that fails, and a robot that leaves the world, change neither the length nor the exit
            status of a run.
        on_warning: ``log`` logs warnings about the scene; ``raise`` refuses a scene that has any.
        file_label: what the names of files that streams write get before their suffix; None if they write no files.
        on_failure: ``deactivate`` switches off a part that raises an error; ``raise`` also raises the error.
    """

    script: str = ""
    arguments: list[str] = field(default_factory=list)
    source_paths: list[str] = field(default_factory=list)
    resource_paths: list[str] = field(default_factory=list)
    node_name: str | None = None
    file_label: str | None = ""
    sockets: bool = True
    interfaces: list[str] = field(default_factory=list)
    view: str = "web"
    host: str = "127.0.0.1"
    view_port: int = 8765
    view_token: str | None = None
    view_origins: list[str] = field(default_factory=list)
    edit_script: bool = False
    open_browser: bool = True
    speed: float | None = None
    duration: float | None = None
    ticks: int | None = None
    seed: int | None = None
    profile: bool = False
    watch: bool = False
    strict: bool = False
    verbose: bool = False
    record: str | None = None
    keep_last: float = 0.0
    record_only: list[str] | None = None
    cameras_on: int | str | None = None
    keep_going: bool = False
    on_warning: str = "log"
    on_failure: str = "deactivate"
