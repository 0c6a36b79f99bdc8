"""What comes from others does not control the terminal, whatever names it and whatever command prints it."""

import ast
import json
import logging
import shutil
import struct
from collections.abc import Callable
from pathlib import Path

import pytest

import morse
from morse.core.reports.log import MorseFormatter
from morse.core.reports.printing import console, echo, harmless, harmless_paragraph
from morse.recording.mcap import records
from morse.recording.recorder import BEGINNING, FORMAT, PRESENT
from tests.kit.programs import commands

SOURCE = Path(morse.__file__).parent
#: window title, clipboard, colours, back to the beginning, C1, direction, no width, other ends of lines
EVIL = {
    "title": "a\x1b]0;owned\x07b",
    "clipboard": "a\x1b]52;c;b3duZWQ=\x07b",
    "clear": "a\x1b[2J\x1b[Hb",
    "back": "safe\rowned\x08\x08",
    "c1": "a\x9b31mb\x90\x9c",
    "bidi": "a\u202egnp.exe\u2066b",
    "zero width": "a\u200b\u2060\ufeffb",
    "lines": "a\u2028b\x85c\x0bd",
    "surrogate": "a\udc9bb",
}
ALLOWED = {"\n", "\t"}


def tame(text: str) -> bool:
    return all(character.isprintable() or character in ALLOWED for character in text)


PRINTERS = ("core/reports/printing.py", "kernel/build.py", "plugins/blend/blend_export.py")


@pytest.mark.parametrize("text", EVIL.values(), ids=EVIL)
def test_the_places_that_print_escape(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    from rich.table import Table
    from rich.text import Text

    echo(text)
    echo(text, err=True)
    table = Table(title=text)
    table.add_column(Text(text))
    table.add_row(Text(text))
    console().print(table)
    record = logging.LogRecord("morse.x", logging.WARNING, "f", 1, "%s", (text,), None)
    out, err = capsys.readouterr()
    for printed in (out, err, harmless(text), harmless_paragraph(text), MorseFormatter().format(record)):
        assert tame(printed)
        assert printed


def test_nothing_else_prints() -> None:
    """Only this module, the log and what the page's tools of the package are call what writes to a terminal."""
    found = []
    for file in sorted(SOURCE.rglob("*.py")):
        name = file.relative_to(SOURCE).as_posix()
        # programs of the build; a script that runs within Blender; programs for users to read
        if name.startswith("data/") or name in (
            "core/reports/printing.py",
            "kernel/build.py",
            "plugins/blend/blend_export.py",
        ):
            continue
        for node in ast.walk(ast.parse(file.read_bytes())):
            if not isinstance(node, ast.Call):
                continue
            call = ast.unparse(node.func)
            writes = ("print", "typer.echo", "click.echo", "Console", "sys.stdout.write", "sys.stderr.write")
            if call in (*writes, "traceback.print_exc", "traceback.print_exception", "logging.basicConfig"):
                found.append(f"{name}:{node.lineno} {call}")
    assert [one for one in found if not one.startswith("core/reports/log.py")] == []


# -- files through commands ------------------------------------------------------------------


def _urdf(folder: Path, name: str) -> Path:
    # XML cannot contain most of these characters, but all of the others
    plain = "".join(c for c in name if c == "\x85" or c >= " ").replace("\udc9b", "\x9b")
    link = f'<link name="{plain}"><visual><geometry><mesh filename="{plain}.stl"/></geometry></visual></link>'
    path = folder / "r.urdf"
    path.write_text(f'<robot name="{plain}">{link}<joint name="j" type="{plain}"/></robot>', encoding="utf-8")
    return path


def _obj(folder: Path, name: str) -> Path:
    path = folder / "r.obj"
    path.write_bytes(
        f"mtllib {name}.mtl\no {name}\nusemtl {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".encode("utf-8", "replace")
    )
    return path


def _gltf(folder: Path, name: str) -> Path:
    (folder / "a.bin").write_bytes(struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0))
    tree = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "name": name}],
        "meshes": [{"name": name, "primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"name": name, "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": f"{name}.png"}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}], "buffers": [{"uri": "a.bin", "byteLength": 36}],
    }  # fmt: skip
    path = folder / "r.gltf"
    path.write_text(json.dumps(tree))
    return path


def _script(folder: Path, name: str) -> Path:
    path = folder / "s.py"
    path.write_text(f"raise ValueError({name!r})\n", encoding="utf-8", errors="surrogateescape")
    return path


def _scene(folder: Path, name: str) -> Path:
    path = folder / "s.py"
    path.write_text(
        f"from morse.builder import *\nrobot = ATRV({name!r})\npose = Pose()\nrobot.append(pose)\n"
        f"pose.properties({{{name!r}: 1}})\nenv = Environment('empty')\n", errors="surrogateescape",
    )  # fmt: skip
    return path


def _recording(folder: Path, name: str) -> Path:
    facts = {FORMAT: str(PRESENT), "seed": name, "tick": "0", "script": name, "morse": name, "sensors": name}
    metadata = records.record(records.METADATA, records.text(BEGINNING) + records.table(facts))
    channel = records.schema(1, name, "ros2msg", b"") + records.channel(1, 1, f"/{name}", "cdr", {})
    one = records.message(records.Message(1, 1, 1, 1, b"\0\1\0\0x"))
    chunk = records.chunk_head(0, 1, len(one), "", len(one)) + one
    path = folder / "r.mcap"
    path.write_bytes(records.MAGIC + records.header("", name) + metadata + channel + chunk)
    return path


def _named(folder: Path, name: str) -> Path:
    path = folder / f"{name.replace('/', '_')}.py"
    path.write_text("from morse.builder import *\n")
    return path


DOORS: dict[str, tuple[Callable[[Path, str], Path], tuple[str, ...]]] = {
    "check a robot": (_urdf, ("check",)),
    "check a mesh": (_obj, ("check",)),
    "check a glTF": (_gltf, ("check",)),
    "check a script": (_script, ("check",)),
    "check a scene": (_scene, ("check",)),
    "run a scene": (_scene, ("run", "--headless", "--duration", "0.05")),
    "run a script": (_script, ("run", "--headless")),
    "run a script with such a name": (_named, ("run", "--headless")),
    "replay": (_recording, ("replay", "--resimulate")),
    "verify": (_recording, ("verify",)),
    "export": (_recording, ("export", "--csv")),
}


def test_names_of_others_are_escaped_by_each_command(tmp_path: Path) -> None:
    name = "".join(text for key, text in EVIL.items() if "\r" not in text and "lines" not in key)
    lines = []
    for number, (make, words) in enumerate(DOORS.values()):
        folder = tmp_path / str(number)
        folder.mkdir()
        more = (str(tmp_path / "out"),) if "--csv" in words else ()
        lines.append((folder, (words[0], str(make(folder, name)), *words[1:], *more)))
    for door, outcome in zip(DOORS, commands(lines, MORSE_SOCKET_PORT=0), strict=True):
        printed = outcome.out + outcome.err
        assert printed, door
        assert tame(printed), (door, [line for line in printed.splitlines() if not tame(line)][:3])
        assert "Traceback" not in printed, door
    for folder, _ in lines:
        shutil.rmtree(folder)  # other programs cannot list such names
