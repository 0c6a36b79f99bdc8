"""``morse export``: the topics of a recording as tables."""

from __future__ import annotations

import os
from typing import Annotated

import typer

from morse.cli.messages import CommandError, say

CONTEXT_SETTINGS = {"allow_interspersed_args": True}


def command(
    file: Annotated[str, typer.Argument(metavar="FILE.mcap", help="A recording.", show_default=False)],
    csv: Annotated[bool, typer.Option("--csv", help="Text that every spreadsheet reads.")] = False,
    parquet: Annotated[bool, typer.Option("--parquet", help="With types, for pandas, Polars, DuckDB, ...")] = False,
    to: Annotated[
        str | None,
        typer.Option("--to", metavar="FOLDER", help="A new folder (default: the name of the file, without .mcap)."),
    ] = None,
    topics: Annotated[
        str | None, typer.Option("--topics", metavar="TOPIC[,TOPIC]", help="Some topics (default: all).")
    ] = None,
) -> int:
    """Write a table for each topic of a recording.

    A row is a message; its columns are simulated time and the fields of the message.
    """
    from morse.core.exceptions import MorseError
    from morse.recording.export import export
    from morse.recording.mcap.reader import McapFile

    if csv == parquet:
        raise CommandError("Say --csv or --parquet: which form the tables have.", 2)
    folder = to or os.path.splitext(os.path.basename(file))[0]
    chosen = [topic.strip() for topic in (topics or "").split(",") if topic.strip()]
    try:
        with McapFile(file) as recording:
            if not recording.complete:
                say("The recording breaks off: what is there is written.")
            written, remarks = export(recording, folder, "csv" if csv else "parquet", chosen)
    except MorseError as error:
        raise CommandError(str(error)) from None
    for remark in remarks:
        say(remark)
    for one in written:
        without = f", without {', '.join(one.left_out)} (--parquet holds them)" if one.left_out else ""
        say(f"{one.path}: {one.rows} rows of {one.topic}{without}")
    return 0
