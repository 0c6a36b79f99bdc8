"""Build the model files of MORSE: ``python tools/assets/build.py [names...] [--preview FOLDER]``.

Without names, all models are built; a name is, for example, ``robots/morsy``. The same scripts give identical bytes.
Needs Blender 3.4, on the PATH or set by MORSE_BLENDER: every later version can open files saved by 3.4, but older
versions cannot open files saved by later ones.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import zstandard
from canonical import canonical

HERE = Path(__file__).resolve().parent
DATA = HERE.parents[1] / "src" / "morse" / "data"
TOOLS = {"build", "canonical", "generate", "preview"}
LEVEL = 19  # compression level


def names() -> list[str]:
    """All models with a script."""
    scripts = (path.relative_to(HERE).with_suffix("").as_posix() for path in HERE.rglob("*.py"))
    return sorted(name for name in scripts if name not in TOOLS and not name.startswith("common/"))


def blender(script: str, *arguments: str) -> None:
    """Run a script inside Blender; ends this program if it fails."""
    program = os.environ.get("MORSE_BLENDER") or shutil.which("blender")
    if program is None:
        sys.exit("No Blender found: install Blender 3.4 or set MORSE_BLENDER to its path.")
    command = [
        program,
        "-b",
        "--factory-startup",
        "-noaudio",
        "--python-exit-code",
        "3",
        "--python",
        str(HERE / script),
        "--",
    ]
    done = subprocess.run([*command, *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{done.stdout}{done.stderr}\n{script} {' '.join(arguments)} failed ({done.returncode})")


def build(name: str, out: Path) -> None:
    """Make one model file."""
    with tempfile.TemporaryDirectory() as folder:
        blender("generate.py", folder, name)
        content = canonical((Path(folder) / f"{name}.blend").read_bytes())
    target = out / f"{name}.blend"
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(zstandard.ZstdCompressor(level=LEVEL).compress(content))
    print(f"{name}.blend  {target.stat().st_size / 1000:.0f} kB", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", help="models to build, e.g. robots/morsy; all if none is given")
    parser.add_argument("--out", type=Path, default=DATA, help="output folder of the .blend files")
    parser.add_argument("--preview", type=Path, help="output folder of a picture of each model")
    options = parser.parse_args()
    known = names()
    unknown = [name for name in options.names if name not in known]
    if unknown:
        parser.error(f"no such model: {', '.join(unknown)}. There are: {', '.join(known)}")
    for name in options.names or known:
        build(name, options.out)
        if options.preview:
            picture = options.preview / f"{name.replace('/', '_')}.png"
            blender("preview.py", str(options.out / f"{name}.blend"), str(picture.resolve()))


if __name__ == "__main__":
    main()
