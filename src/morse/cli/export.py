"""``morse export``: the topics of a recording as tables, the run as a film or a page, a layout for its topics."""

from __future__ import annotations

import contextlib
import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from morse.cli.messages import CommandError, check_other, existing_file, say
from morse.cli.render import drawn, place_of, request_of, shape_of, size_of
from morse.cli.scenes import resolve
from morse.cli.sites import registered
from morse.system.regular_files import check_default_name

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from morse.recording.recording import Recording


# A film of a recorded run.

_FASTEST, _LONGEST = 1000.0, 1e6


class FilmOptions(NamedTuple):
    """The content of a film.

    Attributes:
        camera: name of a camera of the scene, or None.
        places: (x, y, z) of the viewpoint and of the point that it looks at, m; None for those of the script.
        size: width and height, px.
        fov: angle of view, degrees; None for the angle of the script.
        fine: whether four times as many samples are drawn.
        rate: frames per simulated second.
        begin, length: simulated seconds; a length of None is the rest of the recording.
    """

    camera: str | None
    places: tuple[Any, Any]
    size: tuple[int, int]
    fov: float | None
    fine: bool
    rate: float
    begin: float
    length: float | None

    def check(self) -> None:
        """Validate the numbers.

        Raises:
            CommandError: a number is out of range, or options exclude each other.
        """
        if not 0.0 < self.rate <= _FASTEST:
            raise CommandError(f"--rate is a number of frames per second up to {_FASTEST:g}, not {self.rate:g}.", 2)
        check_span(self.begin, self.length)
        if self.camera is not None and (self.places != (None, None) or self.fov is not None):
            raise CommandError(
                "--camera shows the image of a camera: it cannot be combined with --from, --at and --fov.", 2
            )


def check_span(begin: float, length: float | None) -> None:
    """Validate the part of a run that is shown, in simulated seconds.

    Raises:
        CommandError: a number is out of range.
    """
    if not 0.0 <= begin <= _LONGEST:
        raise CommandError(f"--begin is a number of simulated seconds, 0 or more, not {begin:g}.", 2)
    if length is not None and not 0.0 < length <= _LONGEST:
        raise CommandError(f"--length is a number of simulated seconds, not {length:g}.", 2)


def write_film(
    recording: Recording, path: Path, what: FilmOptions, scene: str, *, trust: bool, projects: Sequence[str] = ()
) -> None:
    """Write a film of a recorded run, from its recorded poses or, without them, from a simulation of its inputs.

    Args:
        recording: recording of the run.
        path: path of the film.
        what: content of the film.
        scene: path of a scene script; empty for the scene that the recording describes, or else its script.
        trust, projects: see `morse.launch.recorded_run.options_of`.

    Raises:
        CommandError: there is no such camera, or the recording ends before the film begins.
        MorseError: the run cannot be simulated again.
        OSError: the film cannot be written.
    """
    from morse.launch.recorded_run import timeline_of
    from morse.rendering import picture_files
    from morse.simulation.recordings.timeline import RecordedTimeline

    with contextlib.ExitStack() as stack:
        simulation, timeline = timeline_of(recording, stack, scene, say, trust=trust, projects=projects)
        frequency = simulation.clock.frequency
        first = round(what.begin * frequency)
        last = timeline.length if what.length is None else first + round(what.length * frequency)
        video: Any = None
        frames = absent = 0
        while (position := first + round(frames * frequency / what.rate)) < min(last, timeline.length):
            while not timeline.approach(position):
                pass
            if timeline.position < position:
                break
            frames += 1
            if isinstance(timeline, RecordedTimeline) and what.camera not in (None, *simulation.context.components):
                # its robot may have been spawned later, or deleted
                absent += 1
                continue
            # a restart creates new components
            request = request_of(simulation, what.camera, what.places, what.size, what.fov, what.fine, color=True)
            if video is None:
                video = picture_files.film(path, shape_of(request, what.fine), what.rate)
            video.add(drawn(request, "color", what.fine))
        if video is None and absent:
            timeline.approach(first)
            request_of(simulation, what.camera, what.places, what.size, what.fov, what.fine, color=True)
        if video is None:
            end = timeline.length / frequency
            raise CommandError(f"The recording ends after {end:g} s, before the film begins.")
        video.close()
    drawn_frames = frames - absent
    without = f", without {absent / what.rate:g} s in which there is no {what.camera}" if absent else ""
    say(f"{path}: {drawn_frames} frames of {drawn_frames / what.rate:g} s{without}.")


# A page of a recorded run.


def write_page(
    recording: Recording,
    path: Path,
    span: tuple[float, float | None],
    scene: str,
    *,
    trust: bool,
    projects: Sequence[str] = (),
) -> None:
    """Write a page that plays a recorded run anywhere, without a server.

    Args:
        recording: recording of the run.
        path: of the page.
        span: seconds before the run that is shown, and its length; None for the rest.
        scene, trust, projects: see `morse.launch.recorded_run.timeline_of`.

    Raises:
        MorseError: the run cannot be simulated again.
        OSError: the page cannot be written.
        ValueError: the recording ends before the run that is shown.
    """
    from morse.launch.recorded_run import timeline_of
    from morse.viewer.exported_page import Span, page_of, page_recording_of
    from morse.viewer.live_view import title_of

    with contextlib.ExitStack() as stack:
        simulation, timeline = timeline_of(recording, stack, scene, say, trust=trust, projects=projects)
        title = title_of(recording.facts.get("script", ""), simulation.scene.environment)
        text = page_of(page_recording_of(simulation, timeline, recording, title, Span(*span)), title)
    path.write_text(text, encoding="utf-8", newline="\n")
    say(f"{path}: {len(text.encode()) / 1e6:.1f} MB. Open it in a browser; it needs nothing else.")


def write_layout(file: str, path: Path) -> int:
    """Write the layout for the topics of a recording, or of a scene script that is loaded with Foxglove."""
    from morse.core.exceptions import MorseError
    from morse.middleware.foxglove.layout import layout_of

    try:
        layout = layout_of(*(_recorded(file) if file.endswith(".mcap") else _of_scene(file)))
        path.write_text(json.dumps(layout, indent=1) + "\n", encoding="utf-8")
    except MorseError as error:
        raise CommandError(str(error)) from None
    except OSError as error:
        raise CommandError(f"{path} could not be written, or {file} could not be read: {error}") from None
    say(f"{path}: in Foxglove, open the menu of layouts, and import it from a file.")
    return 0


def _recorded(file: str) -> tuple[dict[str, str], None]:
    from morse.recording.mcap.reader import McapFile

    with McapFile(file) as recording:
        return {channel.topic: channel.type for channel in recording.channels.values()}, None


def _of_scene(file: str) -> tuple[dict[str, str], dict[str, str]]:
    import morse
    from morse.middleware.foxglove.datastream import FoxgloveHub
    from morse.middleware.web.hub import hub_of

    with morse.load(resolve([file]).script, sockets=True, interfaces=["foxglove"]) as simulation:
        simulation.step()  # descriptions and joint states are offered at the end of the first tick
        topics = hub_of(simulation.context, FoxgloveHub).topics
        if topics is None:
            return {}, {}
        offered = {name: topic.type for name, topic in topics.offered.items()}
        return offered, {name: heard.type for name, heard in topics.heard.items()}


#: what the files of some forms have, instead of rows
_COUNTED = {"coco": "pictures", "lerobot": "frames"}
#: headings of the options in the help
_FILM = "Options of --film"
_AGAIN = "Options of --film and --html"
CONTEXT_SETTINGS = {"allow_interspersed_args": True}


def command(
    file: Annotated[str, typer.Argument(metavar="FILE.mcap", help="A recording.", show_default=False)],
    csv: Annotated[bool, typer.Option("--csv", help="Write tables as text, for spreadsheets.")] = False,
    parquet: Annotated[
        bool, typer.Option("--parquet", help="Write tables with typed columns, for pandas, Polars, DuckDB, ...")
    ] = False,
    form: Annotated[
        str | None,
        typer.Option(
            "--as",
            metavar="FORM",
            help="For other tools: tum, kitti, euroc (poses), pcd, las (point clouds), coco (labels), "
            "lerobot (data sets for learning), numpy.",
        ),
    ] = None,
    to: Annotated[
        str | None,
        typer.Option(
            "--to", metavar="FOLDER", help="New folder for the tables (default: the name of the file, without .mcap)."
        ),
    ] = None,
    topics: Annotated[
        str | None, typer.Option("--topics", metavar="TOPIC[,TOPIC]", help="Topics to export (default: all).")
    ] = None,
    mcap: Annotated[
        bool,
        typer.Option(
            "--mcap", help="Write a complete file, if the recording was cut off, or a file with some topics only."
        ),
    ] = False,
    film: Annotated[bool, typer.Option("--film", help="Write a film of the run.")] = False,
    html: Annotated[
        str | None,
        typer.Option("--html", metavar="FILE", help="Write a page that plays the run anywhere, without a server."),
    ] = None,
    foxglove_layout: Annotated[
        bool,
        typer.Option(
            "--foxglove-layout", help="Write a layout of Foxglove for its topics, or for those of a scene script."
        ),
    ] = False,
    output: Annotated[
        str | None,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help="File of --mcap, of the layout or of the film: .gif (default), .webp, frame_%04d.png, by ffmpeg .mp4, "
            ".webm, .mkv.",
        ),
    ] = None,
    origin: Annotated[
        str | None,
        typer.Option(
            "--from",
            rich_help_panel=_FILM,
            metavar="X,Y,Z",
            help="Viewpoint of the film, m (default: that of the script).",
        ),
    ] = None,
    target: Annotated[
        str | None,
        typer.Option(
            "--at",
            rich_help_panel=_FILM,
            metavar="X,Y,Z",
            help="Point that the film looks at, m (default: the origin).",
        ),
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            "--camera", rich_help_panel=_FILM, metavar="ROBOT.CAMERA", help="Film the image of a camera of the scene."
        ),
    ] = None,
    size: Annotated[
        str, typer.Option("--size", rich_help_panel=_FILM, metavar="WxH", help="Size of the film, pixels.")
    ] = "1280x720",
    fov: Annotated[
        float | None, typer.Option("--fov", rich_help_panel=_FILM, help="Angle of view of the film, degrees.")
    ] = None,
    rate: Annotated[float, typer.Option("--rate", rich_help_panel=_FILM, help="Frames per simulated second.")] = 20.0,
    begin: Annotated[
        float,
        typer.Option("--begin", rich_help_panel=_AGAIN, metavar="S", help="Simulated seconds before what is shown."),
    ] = 0.0,
    length: Annotated[
        float | None,
        typer.Option(
            "--length",
            rich_help_panel=_AGAIN,
            metavar="S",
            help="Simulated seconds that are shown (default: the rest).",
        ),
    ] = None,
    fine: Annotated[
        bool, typer.Option("--fine", rich_help_panel=_FILM, help="Draw four times as many pixels, for smoother edges.")
    ] = False,
    scene: Annotated[
        str | None,
        typer.Option(
            "--scene", rich_help_panel=_AGAIN, metavar="PATH", help="A scene script instead of the recorded scene."
        ),
    ] = None,
    trust: Annotated[
        bool,
        typer.Option(
            "--trust",
            rich_help_panel=_AGAIN,
            help="Execute the script that the recording names, if one is needed.",
        ),
    ] = False,
) -> int:
    """Write a table for each topic of a recording, a complete recording, a film or a page of the run.

    Each row is a message; the columns are simulated time and the fields of the message. A film shows the recorded
    poses in the recorded scene, rendered as by `morse render`; a recording of the inputs alone is simulated again,
    which needs a script: see `morse replay --resimulate`.
    """
    from morse.core.exceptions import MorseError
    from morse.core.reports.quoting import nearest, quoted
    from morse.recording.export import FORMS, export
    from morse.recording.mcap.reader import McapFile

    if [csv, parquet, form is not None, mcap, film, html is not None, foxglove_layout].count(True) != 1:
        raise CommandError("Give --csv, --parquet or --as FORM, --mcap, --film, --html or --foxglove-layout.", 2)
    if form is not None and form not in FORMS:
        raise CommandError(f"--as {quoted(form)}: there is no such form{nearest(form, FORMS)}.", 2)
    for written in (output, html):
        check_other(written, file)
    if foxglove_layout:
        if not output:
            _check_default(Path(f"{Path(file).stem}-layout.json"))
        return write_layout(file, Path(output or f"{Path(file).stem}-layout.json"))
    existing_file(file)
    if html is not None:
        check_span(begin, length)
        return _again(
            lambda recording: write_page(
                recording, Path(html), (begin, length), scene or "", trust=trust, projects=registered()
            ),
            file,
            html,
        )
    if film:
        what = FilmOptions(
            camera,
            (place_of(origin, "--from"), place_of(target, "--at")),
            size_of(size),
            fov,
            fine,
            rate,
            begin,
            length,
        )
        if not output:
            _check_default(Path(f"{Path(file).stem}.gif"))
        return _film(file, Path(output or f"{Path(file).stem}.gif"), what, scene or "", trust)
    folder = to or output or os.path.splitext(os.path.basename(file))[0]
    selection = [topic.strip() for topic in (topics or "").split(",") if topic.strip()]
    if mcap:
        return _complete(file, Path(output or f"{Path(file).stem}-complete.mcap"), selection)
    try:
        with McapFile(file) as recording:
            if not recording.complete:
                say("The recording is incomplete: its intact part is exported.")
            paths, remarks = export(recording, folder, form or ("csv" if csv else "parquet"), selection)
    except MorseError as error:
        raise CommandError(str(error)) from None
    for remark in remarks:
        say(remark)
    for one in paths:
        without = f", without {', '.join(one.left_out)} (--parquet exports them)" if one.left_out else ""
        say(f"{one.path}: {one.rows} {_COUNTED.get(form or '', 'rows')} of {one.topic}{without}")
    return 0


def _complete(file: str, path: Path, topics: list[str]) -> int:
    from morse.core.exceptions import MorseError
    from morse.recording.export import rewrite, selected
    from morse.recording.mcap.reader import McapFile

    try:
        with McapFile(file) as recording:
            summary = rewrite(recording, path, selected(recording, topics))
    except MorseError as error:
        raise CommandError(str(error)) from None
    except OSError as error:
        raise CommandError(f"{path} could not be written, or {file} could not be read: {error}") from None
    if summary.damaged:
        say(f"{summary.damaged} damaged chunks are left out.")
    say(f"{path}: {summary.messages} messages.")
    return 0


def _check_default(path: Path) -> None:
    try:
        check_default_name(path)
    except OSError as error:
        raise CommandError(f"-o: {error}.") from None


def _film(file: str, path: Path, what: FilmOptions, scene: str, trust: bool) -> int:
    from morse.rendering import picture_files

    what.check()
    try:
        picture_files.check(path, film=True)
    except ValueError as error:
        raise CommandError(f"-o: {error}.", 2) from None
    return _again(
        lambda recording: write_film(recording, path, what, scene, trust=trust, projects=registered()), file, str(path)
    )


def _again(write: Callable[[Recording], object], file: str, path: str) -> int:
    """Go through a recorded run."""
    from morse.core.exceptions import MorseError
    from morse.core.reports.faults import describe
    from morse.recording.recording import Recording

    try:
        with Recording(file) as recording:
            write(recording)
    except MorseError as error:
        raise CommandError(str(error)) from None
    except OSError as error:
        raise CommandError(f"{path} could not be written, or {file} could not be read: {error}") from None
    except (ValueError, LookupError) as error:
        raise CommandError(f"The scene cannot be simulated again: {describe(error)}") from None
    return 0
