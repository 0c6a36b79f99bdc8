"""Text files in the format of MORSE 1.4."""

import math
import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

import morse
from morse.core.exceptions import MorseError

SCENE = """
from morse.builder import *
robot = ATRV()
robot.translate(1.0, 2.0, 0.0)
robot.rotate(z=0.5)
pose = Pose()
robot.append(pose)
pose.frequency({rate})
{streams}
env = Environment("empty", fastmode=True)
"""

BLOCK = re.compile(
    r"==> Data at X,Y,Z: \[(?P<place>-?\d+\.\d{6} -?\d+\.\d{6} -?\d+\.\d{6})\] "
    r"yaw,pitch,roll: \[(?P<angles>-?\d+\.\d{6} -?\d+\.\d{6} -?\d+\.\d{6})\] "
    r"\| index (?P<index>\d+) \| time (?P<time>\d+\.\d\d)\n(?P<fields>(?:\t\w+ = .+\n)+)"
)


def scene(folder: Path, streams: str = 'pose.add_stream("text")', rate: int = 10) -> Path:
    path = folder / "scene.py"
    path.write_text(SCENE.format(streams=streams, rate=rate))
    return path


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("sockets", [False, True])
def test_a_block_for_each_measurement(tmp_path: Path, sockets: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with morse.load(scene(tmp_path), sockets=sockets) as sim:
        sim.step(60)
    text = (tmp_path / "robot.pose.txt").read_text()
    header, _, rest = text.partition("\n")
    assert header == "ROBOT robot || SENSOR robot.pose"
    blocks = list(BLOCK.finditer(rest))
    assert "".join(block.group() for block in blocks) == rest
    assert [int(block["index"]) for block in blocks] == list(range(10))
    for block in blocks:
        x, y, _ = map(float, block["place"].split())
        assert (x, y) == pytest.approx((1.0, 2.0), abs=1e-3)
        yaw, pitch, roll = map(float, block["angles"].split())
        assert (yaw, pitch, roll) == pytest.approx((0.5, 0.0, 0.0), abs=1e-3)
        fields = dict(line.strip("\t").split(" = ") for line in block["fields"].splitlines())
        assert list(fields) == ["timestamp", "x", "y", "z", "yaw", "pitch", "roll"]
        assert float(fields["timestamp"]) == pytest.approx(float(block["time"]), abs=5.1e-3)
    times = [float(block["time"]) for block in blocks]
    assert all(late - early == pytest.approx(0.1, abs=0.011) for early, late in pairwise(times))


def test_rows_with_semicolons(tmp_path: Path) -> None:
    streams = 'pose.add_stream("text", "morse.middleware.text_datastream.CSVPublisher", file="rows.csv")'
    with morse.load(scene(tmp_path, streams)) as sim:
        sim.step(60)
    names, *rows = [line.split(";") for line in (tmp_path / "rows.csv").read_text().splitlines()]
    assert names == ["timestamp", "x", "y", "z", "yaw", "pitch", "roll"]
    assert len(rows) == 10
    assert all(float(row[names.index("yaw")]) == pytest.approx(0.5, abs=1e-3) for row in rows)


def test_lists_words_and_infinity(tmp_path: Path) -> None:
    streams = """
scan = Hokuyo()
robot.append(scan)
scan.properties(resolution=90.0, scan_window=180.0)
scan.frequency(10)
gps = GPS()
gps.level("extended")
robot.append(gps)
for part in (scan, gps):
    part.add_stream("text")
"""
    script = scene(tmp_path, streams)
    text = script.read_text() + "env.properties(longitude=1.4, latitude=43.6, altitude=135.0)\n"
    script.write_text(text)
    with morse.load(script) as sim:
        sim.step(6)
    lines = (tmp_path / "robot.scan.txt").read_text().splitlines()
    (ranges,) = [line for line in lines if line.startswith("\trange_list = ")][:1]
    assert eval(ranges.partition(" = ")[2]) == [30.0, 30.0, 30.0], "nothing is near, the Hokuyo sees 30 m"
    words = (tmp_path / "robot.gps.txt").read_text()
    assert re.search(r"^\tdate = '\d{6}'$", words, re.MULTILINE)
    assert not math.isnan(float(re.search(r"^\tlatitude = (.*)$", words, re.MULTILINE)[1]))


def test_a_file_goes_on_after_a_reset(tmp_path: Path) -> None:
    with morse.load(scene(tmp_path)) as sim:
        sim.step(60)
        sim.restart()
        sim.step(60)
    text = (tmp_path / "robot.pose.txt").read_text()
    assert text.count("ROBOT ") == 1
    assert [int(block["index"]) for block in BLOCK.finditer(text)] == [*range(10), *range(10)]


def test_others_read_while_the_simulation_runs(tmp_path: Path) -> None:
    with morse.load(scene(tmp_path)) as sim:
        sim.step(60)
        assert len(BLOCK.findall((tmp_path / "robot.pose.txt").read_text())) == 10


@pytest.mark.parametrize(
    ("streams", "said"),
    [
        ('pose.add_stream("text", file="/nowhere/at/all.txt")', "/nowhere/at/all.txt cannot be written"),
        ('pose.add_stream("text", file=3)', "file"),
        ('pose.add_stream("text", files="a")', "did you mean 'file'"),
        ('pose.add_stream("text"); pose.add_stream("text")', "is the file of another stream of robot.pose"),
        ('pose.add_stream("text", direction="IN")', "cannot take commands"),
        ('m = MotionVW(); robot.append(m); m.add_stream("text")', "cannot take commands"),
        ('m = VideoCamera(); robot.append(m); m.add_stream("text")', "cannot carry"),
    ],
)
def test_what_cannot_be_written_is_said(tmp_path: Path, streams: str, said: str) -> None:
    with pytest.raises(MorseError, match=re.escape(said)):
        morse.load(scene(tmp_path, streams)).close()


def test_a_full_disk_ends_the_file_alone(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    full = "/dev/full"  # every write fails
    with morse.load(scene(tmp_path, f'pose.add_stream("text", file="{full}")')) as sim:
        sim.step(600)
        assert sim.clock.tick == 600
        assert "robot.pose" not in sim.context.failed
    assert caplog.text.count("nothing more is written to /dev/full") == 1


def test_the_example_of_the_documentation(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = (Path(__file__).parents[2] / "docs" / "text-files.md").read_text(encoding="utf-8")
    described, reader = (block.partition("```")[0] for block in page.split("```python\n")[1:])
    (tmp_path / "default.py").write_text(described)
    with morse.load(tmp_path / "default.py") as sim:
        sim.step(120)
    begin = page.split("```text\n")[1].splitlines()[0]
    assert (tmp_path / "robot.pose.txt").read_text().startswith(begin + "\n==> Data at X,Y,Z: [")
    done = subprocess.run([sys.executable, "-c", reader], cwd=tmp_path, capture_output=True, text=True, check=True)
    # a battery with the default discharge of 0.05 % per second has lost no more than that
    assert re.fullmatch(r"\d+ measurements, charge at the end (99\.\d\d|100\.00) %\n", done.stdout)


def test_each_row_of_a_batch_has_its_own_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    table = '"morse.middleware.text.datastream.CSVPublisher", file="poses.csv"'
    streams = f'pose.add_stream("text"); pose.add_stream("text", {table})'
    path = scene(tmp_path, streams)
    with morse.batch(path, 3) as many:
        pose = many.read("robot.pose", "x")
        many.place([0, 1, 2], "robot", [[5.0 + row, 0.0, 0.5] for row in range(3)])
        many.step(30, measure=True)
        assert pose.round(1).ravel().tolist() == [5.0, 6.0, 7.0]
    written = {file.name: file.read_text() for file in tmp_path.iterdir() if file != path}
    assert sorted(written) == sorted(
        f"{name}-row{row}{suffix}" for row in range(3) for name, suffix in (("robot.pose", ".txt"), ("poses", ".csv"))
    )
    for row in range(3):
        blocks = list(BLOCK.finditer(written[f"robot.pose-row{row}.txt"]))
        assert [int(block["index"]) for block in blocks] == list(range(len(blocks)))
        assert float(blocks[-1]["place"].split()[0]) == pytest.approx(5.0 + row, abs=0.01)
        assert len(written[f"poses-row{row}.csv"].splitlines()) == 1 + len(blocks)


@pytest.mark.parametrize("label", ["../x", "a/b", "a\n", "x" * 41, 3])
def test_a_label_of_files_stays_in_its_folder(label, tmp_path):
    with pytest.raises(ValueError, match="file_label is a part of the name of a file"):
        morse.load(scene(tmp_path), file_label=label)
