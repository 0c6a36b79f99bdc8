"""The program that expands files of xacro: ``python -m morse.assets.urdf.xacro_program``.

The expressions in such a file are Python: `morse.assets.urdf.xacro_limits` limits what they can reach, and this process
has a limit of time and memory, and none of the environment variables of the user. The question is an object in JSON
with ``path`` and ``arguments``, the answer one with ``text`` or ``error``.
"""

from __future__ import annotations

import json
from pathlib import Path

from morse.assets.nearby_files import FileRefusedError, find_package
from morse.assets.urdf.xacro_limits import MOST_MEMORY, TIME_LIMIT, limit
from morse.system.workers import Server, limit_resources, serve_program


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
    limit(path, packages, arguments)
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


class Expansion(Server):
    """Expands files."""

    def answer(self, question: bytes) -> bytes:
        """Expand the file of a question."""
        about = json.loads(question)
        return json.dumps(expand(Path(about["path"]), about["arguments"])).encode()


def main() -> None:
    """Expand the files of the process that has started this one."""
    limit_resources(TIME_LIMIT, MOST_MEMORY)
    serve_program(Expansion, watches=False)


if __name__ == "__main__":
    main()
