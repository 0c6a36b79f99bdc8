"""Model files that ask for much more work than their size suggests are loaded or refused soon, in one line."""

import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hostile_files import RECORDINGS
from hostile_meshes import MESHES, soup, stl
from hostile_pictures import BLENDS, PICTURES
from hostile_robots import ROBOTS

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the limits of processes are those of Linux")

COURT = Path(__file__).with_name("court.py")
#: processor time on a quiet machine, s, and how many times more a machine whose caches others use may take
SECONDS, BUSY = 5, 3
#: memory of a process, and address space, of which libraries reserve more than they use, bytes
MEMORY, SPACE = 500_000_000, 4 << 30
ALL = {**MESHES, **ROBOTS, **PICTURES, **BLENDS, **RECORDINGS}
#: one or two of each class that are decided quickly
SHORT = (
    "collada: instances, depth 22", "collada: circle", "collada: no scene", "collada: 100,000 instances of a geometry",
    "gltf: 40 times one sparse file", "gltf: 9,000 uses of one array", "gltf: matrix of 1e308", "gltf: nested lists",
    "obj: polygon of 1.2 M corners", "ply: 370,000 equal triangles", "ply: 4,000,000,000 vertices", "stl: wrong count",
    "mjcf: 250,000 comments without an end", "sdf: 250,000 comments without an end", "sdf: 19,000 joints of one name",
    "urdf: 1,000,000 blanks in a substitution",
    "mjcf: 90,000 equal boxes", "mjcf: nested replicate", "mjcf: files that include each other twice",
    "urdf: 100,000 links", "urdf: 1,990 moving links with masses", "urdf: collada instances", "urdf: entities",
    "picture: 60 materials, one picture",
    "picture: 30,000 x 30,000", "picture: JPEG of 14,000 scans", "picture: TIFF of 60 GB of tags",
    "picture: TIFF within a glTF", "picture: PNG of 3,000,000 parts", "blend: zstandard bomb",
    "blend: 190,000 empty gzip parts", "recording: 20,000,000 inputs", "recording: 200,000,000 empty records",
    "recording: one description, 500,000 times", "state: nested lists", "state: 4,000,000,000 items",
)  # fmt: skip


@pytest.fixture(scope="module")
def judged(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[str], dict[str, Any]]]:
    """A function that loads a file in a process of its own."""
    folder = tmp_path_factory.mktemp("hostile")
    first = folder / "first.stl"
    first.write_bytes(stl(soup(3)))
    # other threads would only add the processor time that they take to wait
    environment = {
        **os.environ,
        "OPENBLAS_NUM_THREADS": "1",
        "MORSE_THREADS": "1",
        "MORSE_CACHE": str(folder / "cache"),
    }
    with subprocess.Popen(
        [sys.executable, str(COURT), str(SECONDS * BUSY), str(SPACE), str(first)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment,
    ) as court:  # fmt: skip

        def judge(name: str) -> dict[str, Any]:
            case = folder / f"case{len(list(folder.iterdir()))}"
            case.mkdir()
            path = ALL[name](case)
            assert court.stdin is not None
            assert court.stdout is not None
            court.stdin.write(f"{path}\n")
            court.stdin.flush()
            answer: dict[str, Any] = json.loads(court.stdout.readline())
            for file in case.iterdir():
                file.unlink()
            return {**answer, "file": path.name}

        yield judge
        court.stdin.close()


def check(answer: dict[str, Any]) -> None:
    """What the user sees is one line that names the file, and neither time nor memory is wasted."""
    assert answer["signal"] == 0, f"ended by signal {answer['signal']} after {answer['seconds']:.1f} s"
    assert answer["memory"] <= MEMORY
    text = answer["answer"]
    if text != "loaded":
        assert text.count("\n") == 0, text
        assert answer["file"] in text or "object '" in text, text
        for word in ("AttributeError", "ModuleNotFoundError", "TypeError", "KeyError", "IndexError", "MemoryError"):
            assert word not in text


@pytest.mark.parametrize("name", SHORT)
def test_each_class_is_answered_soon(judged: Callable[[str], dict[str, Any]], name: str) -> None:
    check(judged(name))


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in ALL if name not in SHORT])
def test_all_are_answered_soon(judged: Callable[[str], dict[str, Any]], name: str) -> None:
    check(judged(name))


def test_there_are_many_of_each_format() -> None:
    counts = Counter(name.partition(":")[0] for name in ALL)
    assert counts.total() >= 100
    assert min(counts.values()) >= 8
