"""Readers of model files that installed packages bring."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

READER = (
    "from morse.scene import Library, Node\ndef read(path):\n    return Library(str(path), roots=[Node('crate')])\n"
)


def loaded(site: Path, name: str, reader: str, points: str = "crate = my_lab:read") -> subprocess.CompletedProcess[str]:
    """Load the model of that name with an installed reader of ``.crate`` files."""
    for path, text in {
        "my_lab.py": reader,
        "my_lab-1.0.dist-info/METADATA": "Metadata-Version: 2.1\nName: my_lab\nVersion: 1.0\n",
        "my_lab-1.0.dist-info/entry_points.txt": f"[morse.formats]\n{points}\n",
        "yard.crate": "",
    }.items():
        (site / path).parent.mkdir(exist_ok=True)
        (site / path).write_text(text, encoding="utf-8")
    program = (
        f"import sys; sys.path.append({str(site)!r})\n"
        f"from morse.assets import find, load\nprint([node.name for node in load(find({name!r})).roots])"
    )
    environment = {**os.environ, "MORSE_RESOURCE_PATH": str(site)}
    return subprocess.run(
        [sys.executable, "-c", program], env=environment, capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.parametrize("name", ["yard.crate", "yard"])
def test_a_file_of_the_package_is_read(tmp_path: Path, name: str) -> None:
    done = loaded(tmp_path, name, READER)
    assert done.stdout.strip() == "['crate']", done.stderr


def test_a_broken_reader_is_named(tmp_path: Path) -> None:
    done = loaded(tmp_path, "yard.crate", "1 / 0\n")
    assert "the reader of an installed package (my_lab:read) cannot be loaded: ZeroDivisionError" in done.stderr


def test_no_package_takes_scene_scripts_or_files_that_have_a_reader(tmp_path: Path) -> None:
    reader = f"{READER}from morse.assets import formats; from pathlib import Path\n" + (
        "def report(path):\n    print(formats.is_model(Path('scene.py')))\n    return read(path)\n"
    )
    points = "crate = my_lab:report\nPY = my_lab:read\nstl = my_lab:read"
    done = loaded(tmp_path, "yard.crate", reader, points)
    assert done.stdout.split("\n")[0] == "False", done.stderr
    assert "files .py are MORSE's" in done.stderr
    assert "files .stl are MORSE's" in done.stderr


def test_what_is_no_reader_is_named(tmp_path: Path) -> None:
    done = loaded(tmp_path, "yard.crate", "read = 3\n")
    assert "the reader of an installed package (my_lab:read) cannot be loaded: TypeError: it is 3" in done.stderr
