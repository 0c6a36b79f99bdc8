"""The program that expands a file of xacro: ``python -m morse.assets.urdf.xacro_program FILE ARGUMENTS``.

The expressions in such a file are Python: `morse.assets.urdf.xacro_limits` limits what they can reach, and this program
the time and memory that they take. The result is a line of JSON, an object with ``text`` or ``error``.
"""

from __future__ import annotations

import contextlib
import json
import sys
from pathlib import Path

from morse.assets.nearby_files import FileRefusedError, find_package
from morse.assets.urdf.xacro_limits import limit

#: bytes
MOST_MEMORY = 2 << 30


def expand(path: Path, arguments: dict[str, str]) -> dict[str, str]:
    """Return the text of a file without macros, or the reason why there is none."""
    import xacro
    from xacro import substitution_args

    refusals: list[str] = []
    packages: list[Path] = []

    def package(name: str) -> str:
        try:
            packages.append(find_package(name, path))
            return str(packages[-1])
        except FileRefusedError as error:
            # xacro raises errors of its own instead
            refusals.append(f"$(find {name[:60]}): {error}")
            raise

    # without ROS, xacro cannot find packages
    substitution_args._eval_find = package
    limit(path, packages)
    try:
        document = xacro.process_file(str(path), mappings=arguments)
    except RecursionError:
        return {"error": "xacro cannot expand it: a file or a macro contains itself, or it is nested too deeply"}
    except Exception as error:  # the expressions of the file raise anything
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        return {"error": refusals[0] if refusals else f"xacro cannot expand it: {reason:.300}"}
    if not document.getElementsByTagName("link"):
        return {"error": "it defines macros or properties, and no links: load the file that includes it"}
    return {"text": document.toxml()}


def limit_memory() -> None:
    """Set a limit where the system has one."""
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))


def main() -> None:
    """Expand the file that the command line names."""
    limit_memory()
    output, sys.stdout = sys.stdout, sys.stderr
    output.write(json.dumps(expand(Path(sys.argv[1]), json.loads(sys.argv[2]))))


if __name__ == "__main__":
    main()
