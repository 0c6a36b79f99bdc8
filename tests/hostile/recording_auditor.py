"""Reads recordings in a process of its own, and reports what an audit hook of Python sees.

``python recording_auditor.py COMMANDS``: a JSON list of command lines of ``morse``; ``["show", FILE]`` shows a
recording on a page without a browser. One line of JSON follows for each: exit status, errors, and suspicious events.
"""

import contextlib
import io
import json
import os
import sys
from typing import Any

#: a name in a file or of a module that only a foreign program has
FOREIGN = ("evil", "harm", "timeit")
_PROCESSES = ("os.system", "os.exec", "os.fork", "os.posix_spawn", "os.spawn", "subprocess.Popen", "pty.spawn")
_seen: list[str] = []


def _is_foreign(name: Any) -> bool:
    return isinstance(name, (str, bytes)) and any(word in os.path.basename(os.fsdecode(name)) for word in FOREIGN)


def _audit(event: str, arguments: tuple[Any, ...]) -> None:
    if event in _PROCESSES:
        _seen.append(f"{event} {arguments!r:.200}")
    elif event == "exec" and _is_foreign(getattr(arguments[0], "co_filename", "")):
        _seen.append(f"exec {arguments[0].co_filename}")
    elif event == "compile" and _is_foreign(arguments[1]):
        _seen.append(f"compile {arguments[1]!r}")
    elif event == "import" and _is_foreign(arguments[0]):
        _seen.append(f"import {arguments[0]}")
    elif event == "open" and _is_foreign(arguments[0]) and str(arguments[0]).endswith(".obj"):
        _seen.append(f"open {arguments[0]}")


def _show(path: str) -> int:
    from morse.core.exceptions import MorseError
    from morse.launch.playing import playing
    from morse.recording.recording import Recording

    try:
        with Recording(path) as recording, playing(recording, port=0, browser=False) as view:
            for position in (0, 1, view._timeline.length, 0):
                while not view._timeline.approach(position):
                    pass
                view.after_tick()
    except MorseError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


def main(commands: list[list[str]]) -> None:
    """Run the commands."""
    # what reads no recording is imported before: the platform may start programs to find libraries
    import morse.launch.playing
    import morse.rendering
    from morse.cli.app import execute

    del morse
    sys.path.insert(0, os.getcwd())
    sys.addaudithook(_audit)
    for words in commands:
        _seen.clear()
        errors = io.StringIO()
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(errors):
            status = _show(words[1]) if words[0] == "show" else execute(words)
        seen = [*_seen]
        sys.__stdout__.write(json.dumps({"status": status, "error": errors.getvalue(), "seen": seen}) + "\n")  # type: ignore[union-attr]


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
