"""``python -m pymorse [HOST [PORT]]``: write the types of a running simulation."""

from __future__ import annotations

import sys

from pymorse.pymorse import Morse
from pymorse.stubs import stubs

_USAGE = "usage: python -m pymorse [HOST [PORT]] > my_scene.py"


def main(arguments: list[str]) -> int:
    """Write the module to the standard output; return the exit status."""
    host = arguments[0] if arguments else "localhost"
    port = arguments[1] if len(arguments) > 1 else None
    if len(arguments) > 2 or host.startswith("-") or not (port is None or port.isdecimal()):
        print(_USAGE, file=sys.stderr)
        return 2
    try:
        with Morse(host, None if port is None else int(port)) as simu:
            print(stubs(simu), end="")
    except ConnectionError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
