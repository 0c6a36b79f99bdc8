"""The optional packages of MORSE, and the commands that install them."""

from __future__ import annotations

import re

NAME = "morse-simulator"
#: how an installation that is damaged, or lacks the kernel, is mended
REINSTALL = "pip install --force-reinstall . in a copy of MORSE's sources, or a wheel that was made there"

_REQUIREMENT = re.compile(r"\s*([\w.-]+)\s*\(?([^;)]*?)\)?\s*;.*\bextra\s*==\s*['\"]([\w.-]+)['\"].*", re.DOTALL)


def packages(extra: str) -> list[str]:
    """The requirements of an extra, as in ``paho-mqtt>=2,<3``, by the metadata of the installation.

    Args:
        extra: its name in ``[project.optional-dependencies]``.

    Returns:
        The requirements in the form of pip; empty if MORSE runs from a folder of sources that is not installed.
    """
    from importlib import metadata  # 30 ms, and only needed where something is missing

    try:
        lines = metadata.requires(NAME) or []
    except metadata.PackageNotFoundError:
        return []
    found = [match.groups() for line in lines if (match := _REQUIREMENT.fullmatch(line))]
    # lower bounds first, as in pyproject.toml
    return [
        name + ",".join(sorted(versions.replace(" ", "").split(","), reverse=True))
        for name, versions, of in found
        if of == extra
    ]


def install(extra: str) -> str:
    """The command that installs the packages of an extra, wherever MORSE has been installed from.

    The quotation marks are those that the shells of all systems understand.
    """
    words = packages(extra) or [f".[{extra}]"]
    command = "pip install " + " ".join(f'"{word}"' for word in words)
    return command if packages(extra) else f"{command} in a copy of MORSE's sources"
