"""``morse export``: the topics of a recording as tables, the run as a film or a page, a layout for its topics."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from morse.cli.filming import Filmed, check_span
from morse.cli.filming import film as write_film
from morse.cli.messages import CommandError, check_other, existing_file, say
from morse.cli.paging import page as write_page
from morse.cli.scenes import resolve
from morse.cli.sites import registered
from morse.cli.viewing import place_of, size_of
from morse.system.regular_files import check_default_name

if TYPE_CHECKING:
    from collections.abc import Callable

    from morse.recording.recording import Recording


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
    from morse.middleware.foxglove.hub import FoxgloveHub
    from morse.middleware.web.hub import hub_of

    with morse.load(resolve([file]).script, sockets=True, interfaces=["foxglove"]) as simulation:
        simulation.step()  # descriptions and joint states are offered at the end of the first tick
        topics = hub_of(simulation.context, FoxgloveHub).topics
        if topics is None:
            return {}, {}
        offered = {name: topic.type for name, topic in topics.offered.items()}
        return offered, {name: heard.type for name, heard in topics.heard.items()}


#: headings of the options in the help
_FILM = "Options of --film"
_AGAIN = "Options of --film and --html"
CONTEXT_SETTINGS = {"allow_interspersed_args": True}


def command(
    file: Annotated[str, typer.Argument(metavar="FILE.mcap", help="A recording.", show_default=False)],
    csv: Annotated[bool, typer.Option("--csv", help="As text, for spreadsheets.")] = False,
    parquet: Annotated[
        bool, typer.Option("--parquet", help="As typed columns, for pandas, Polars, DuckDB, ...")
    ] = False,
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
        bool, typer.Option("--mcap", help="As a complete file, if the recording was cut off, or with some topics only.")
    ] = False,
    film: Annotated[bool, typer.Option("--film", help="A film of the run.")] = False,
    html: Annotated[
        str | None,
        typer.Option("--html", metavar="FILE", help="As a page that plays the run anywhere, without a server."),
    ] = None,
    foxglove_layout: Annotated[
        bool,
        typer.Option("--foxglove-layout", help="A layout of Foxglove for its topics, or for those of a scene script."),
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
    from morse.recording.export import export
    from morse.recording.mcap.reader import McapFile

    if [csv, parquet, mcap, film, html is not None, foxglove_layout].count(True) != 1:
        raise CommandError("Give --csv or --parquet for tables, --mcap, --film, --html or --foxglove-layout.", 2)
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
        what = Filmed(
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
            paths, remarks = export(recording, folder, "csv" if csv else "parquet", selection)
    except MorseError as error:
        raise CommandError(str(error)) from None
    for remark in remarks:
        say(remark)
    for one in paths:
        without = f", without {', '.join(one.left_out)} (--parquet exports them)" if one.left_out else ""
        say(f"{one.path}: {one.rows} rows of {one.topic}{without}")
    return 0


def _complete(file: str, path: Path, topics: list[str]) -> int:
    from morse.core.exceptions import MorseError
    from morse.recording.export import selected
    from morse.recording.mcap.reader import McapFile
    from morse.recording.rewriting import rewrite

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


def _film(file: str, path: Path, what: Filmed, scene: str, trust: bool) -> int:
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
