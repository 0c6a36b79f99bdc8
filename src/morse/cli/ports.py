"""TCP ports among the arguments of programs."""

from __future__ import annotations

import argparse


def port_number(text: str, least: int) -> int:
    """Return a TCP port.

    Args:
        text: the argument.
        least: 0 where it stands for any free port, else 1.

    Raises:
        ArgumentTypeError: it is no port.
    """
    if not (text.isascii() and text.isdecimal() and len(text) <= 5 and least <= int(text) < 1 << 16):
        raise argparse.ArgumentTypeError(f"'{text:.40}' is not a TCP port from {least} to 65535")
    return int(text)
