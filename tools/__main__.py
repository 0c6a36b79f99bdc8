"""Writes what is derived from the components, and the files of a release.

``python -m tools [stubs] [pictures [NAME...]] [library]``: the stubs of `morse.builder`, those pictures of the
component library that are missing, and its pages. With the names of components, their pictures are taken again.

``python -m tools compatibility [ARGUMENT...]``: docs/compatibility.md, from the tests with programs that others wrote.

``python -m tools validation``: docs/validation.md, which compares the models with formulas, standards and data sheets.

``python -m tools reach FOLDER...``: tries the robots and worlds in folders of others: what loads, stands and drives.

``python -m tools release [FOLDER]``: the source distribution and the wheels of all platforms, verified.

``python -m tools rehearse [FOLDER]``: the same, then an installation from a local index, a demo and the documentation.

``python -m tools arm64 [WHEEL]``: tries the wheel for Linux on ARM64 in an emulator.

``python -m tools wine [WHEEL]``: tries the kernel of the wheel for Windows.

``python -m tools oracles``: tests/oracles.json, the bits of demos, recipes and topics that a change keeps.

``python -m tools structure``: the size of the sources: files, lines, short files, lines without types.

``python -m tools trace``: the files that a command enters on its way from the socket to the wheel.

``python -m tools site FOLDER``: adds the documentation of this version to a site.
"""

from __future__ import annotations

import sys
from pathlib import Path

_PARTS = ("stubs", "pictures", "library")


def main(arguments: list[str]) -> int:
    """Run the command; the result is the status of the process."""
    part, *names = arguments or ["all"]
    if part in ("release", "rehearse") and len(names) <= 1:
        from tools.release import rehearsal

        return getattr(rehearsal, part)(Path(*names) if names else Path("dist"))
    if part in ("arm64", "wine") and len(names) <= 1:
        from tools.release import arm64, wine

        return {"arm64": arm64, "wine": wine}[part].main(Path(*names) if names else None)
    if part == "site" and len(names) == 1:
        from tools.release import site

        return site.main(Path(*names))
    if part == "compatibility":
        from tools import compatibility

        return compatibility.main(names)
    if part == "reach":
        from tools import reach

        return reach.main(names)
    if part == "oracles" and not names:
        from tools import oracles

        return oracles.main()
    if part == "structure" and not names:
        from tools import structure

        return structure.main()
    if part == "trace" and not names:
        from tools import trace

        return trace.main()
    if part == "validation" and not names:
        from tools.validation import page

        return page.main()
    if part not in ("all", *_PARTS) or (names and part != "pictures"):
        print(__doc__, file=sys.stderr)
        return 2
    from tools.gallery import components
    from tools.stubs import builder_stubs

    if part in ("all", "stubs"):
        builder_stubs.main()
    status = components.main(names) if part in ("all", "pictures") else 0
    if part in ("all", "library"):
        # as the documentation imports it
        sys.path.insert(0, str(Path(__file__).parents[1] / "docs"))
        import component_library

        component_library.write(Path(__file__).parents[1] / "docs" / component_library.FOLDER)
    return status


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
