"""Writes the files that are derived from the components: ``python -m tools [stubs] [pictures [NAME...]]``.

Without arguments: the stubs of `morse.builder`, and those pictures of the component library that are missing. With the
names of components, their pictures are taken again.
"""

from __future__ import annotations

import sys

from tools.gallery import components
from tools.stubs import builder_stubs

_PARTS = ("stubs", "pictures")


def main(arguments: list[str]) -> int:
    """Run the command; the result is the status of the process."""
    part, *names = arguments or ["all"]
    if part not in ("all", *_PARTS) or (names and part != "pictures"):
        print(__doc__, file=sys.stderr)
        return 2
    if part in ("all", "stubs"):
        builder_stubs.main()
    return components.main(names) if part in ("all", "pictures") else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
