"""``morse export --foxglove-layout``: a layout of Foxglove for a recording or a scene."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from morse.cli.messages import CommandError, say
from morse.cli.scenes import resolve

if TYPE_CHECKING:
    from pathlib import Path


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
