"""Steps of a rehearsal: programs that have to end without an error, one after the other."""

from __future__ import annotations

import subprocess
import sys
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

#: characters of the output of a failed step
_SHOWN = 8000


def run(title: str, command: Sequence[str], folder: Path, settings: Mapping[str, str] | None = None) -> str | None:
    """Run one program and print how it ended.

    Args:
        title: the name of the step.
        command: the program and its arguments.
        folder: its working directory.
        settings: its environment; that of this process if None.

    Returns:
        What the program has printed; None if it has failed, and its output has been printed.
    """
    start = time.monotonic()
    done = subprocess.run(
        command, cwd=folder, env=settings, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, encoding="utf-8"
    )
    seconds = time.monotonic() - start
    print(f"{'ok    ' if done.returncode == 0 else 'FAILED'} {title:8} {seconds:6.1f} s", flush=True)
    if done.returncode:
        print(done.stdout[-_SHOWN:], file=sys.stderr)
        return None
    return done.stdout
