"""Finding and running the user's Blender."""

from __future__ import annotations

import shutil
import subprocess

from morse.system import variables

INSTALL = "sudo apt-get install blender, or https://www.blender.org/download; then set MORSE_BLENDER if not on the PATH"


def find() -> tuple[str | None, str]:
    """The Blender program to use.

    Returns:
        The path of the program and its origin; or None and the reason.
    """
    if program := variables.text("MORSE_BLENDER"):
        path = shutil.which(program)
        return (path, "$MORSE_BLENDER") if path else (None, f"MORSE_BLENDER is '{program}', which is not a program")
    path = shutil.which("blender")
    return (path, "PATH") if path else (None, "neither MORSE_BLENDER nor the PATH contains it")


def version(program: str) -> str:
    """Return the first line of ``blender --version``, or the reason why it failed."""
    try:
        output = subprocess.run(
            [program, "--version"], capture_output=True, encoding="utf-8", errors="replace", timeout=20, check=True
        ).stdout
    except (OSError, subprocess.SubprocessError) as error:
        return f"{program} does not run: {error}"
    return output.strip().splitlines()[0] if output.strip() else f"{program} does not print its version"
