"""Checks of the recipes that are programs."""

import csv
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from PIL import Image


class Done(NamedTuple):
    """A program that has ended.

    Attributes:
        names: its variables.
        folder: the folder in which it ran.
        places: the objects of its last simulation at the end: positions, m.
        output: what it printed.
    """

    names: dict[str, Any]
    folder: Path
    places: dict[str, list[float]]
    output: str


def _points(done: Done) -> None:
    for place, goal in zip(done.names["places"], [(3.0, 0.0), (3.0, 3.0), (0.0, 3.0)], strict=True):
        assert math.dist((place["x"], place["y"]), goal) < 0.3


def _follow(done: Done) -> None:
    assert 1.2 < done.names["far"] < 1.9
    assert done.places["robot"][0] > 10.0


def _avoid(done: Done) -> None:
    assert not done.names["touched"].touched
    assert "no contact" in done.output


def _dock(done: Done) -> None:
    assert 0.5 < math.dist(done.places["robot"][:2], (6.0, 1.5)) < 2.0
    assert abs(done.names["right"]) < 0.3


def _takes_off(done: Done) -> None:
    place = done.names["place"]
    assert math.dist((place["x"], place["y"], place["z"]), (6.0, 3.0, 4.0)) < 0.5


def _wind(done: Done) -> None:
    assert abs(done.names["calm"]["y"]) < 0.05
    assert done.names["blown"]["y"] > 0.2


def _photo(done: Done) -> None:
    image = Image.open(done.folder / "photo.png")
    assert image.size == (480, 300)
    assert np.asarray(image).std() > 20.0


def _film(done: Done) -> None:
    film = Image.open(done.folder / "film.gif")
    assert getattr(film, "n_frames", 1) == 20


def _cloud(done: Done) -> None:
    lines = (done.folder / "cloud.ply").read_text().splitlines()
    points = np.loadtxt(lines[7:])
    assert lines[2] == f"element vertex {len(points)}"
    assert points.shape[1] == 3
    assert 1.0 < np.median(points[:, 2]) < 30.0


def _map(done: Done) -> None:
    dark = np.asarray(Image.open(done.folder / "map.png")) == 0
    assert dark.sum(axis=0).max() > 100  # a wall of more than ten metres
    assert dark.mean() < 0.02


def _csv(done: Done) -> None:
    with (done.folder / "pose.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 120
    assert float(rows[-1]["yaw"]) == pytest.approx(0.5 * 2.0, abs=0.05)


def _record(done: Done) -> None:
    assert (done.folder / "run.mcap").stat().st_size > 10_000


def _page(done: Done) -> None:
    assert 100_000 < (done.folder / "run.html").stat().st_size < 5_000_000


def _odometry(done: Done) -> None:
    errors = done.names["errors"]
    assert np.mean(errors[:5]) < np.mean(errors[-5:])
    assert errors[-1] > 0.1


def _spawn(done: Done) -> None:
    assert {"crate0", "crate1", "crate2"} <= set(done.names["names"])
    assert "crate3" not in done.names["names"]
    heights = [done.places[f"crate{number}"][2] for number in range(3)]
    assert heights == sorted(heights)


def _contact(done: Done) -> None:
    other, impulse = re.fullmatch(r"touches (\w+) with ([\d.]+) N s\n", done.output).groups()
    assert other == "small_crate"
    assert float(impulse) > 1.0


def _dominoes(done: Done) -> None:
    assert all(done.places[f"stone{number}"][2] < 0.55 for number in range(3))  # 0.6 m while they stand
    assert "fallen: ['stone0', 'stone1', 'stone2'" in done.output


def _pick(done: Done) -> None:
    assert "grasped tape" in done.output
    assert math.dist(done.places["tape"][:2], (1.1, 0.0)) > 0.5


def _arm(done: Done) -> None:
    tip = np.array(done.places["kuka_7"])
    assert np.linalg.norm(tip - [0.9, 0.3, 1.2]) < 0.25  # the flange is behind the tip


def _again(done: Done) -> None:
    reached = done.names["reached"]
    assert reached[0.5] == pytest.approx(-reached[-0.5], abs=1e-6)
    # a circle with the radius v / w after 2 s
    assert reached[0.5] == pytest.approx(2.0 * (1.0 - math.cos(1.0)), abs=0.1)


def _hour(done: Done) -> None:
    assert done.output.startswith("3600 s in ")


def _batch(done: Done) -> None:
    pose = done.names["pose"]
    assert pose.shape == (16, 2)
    assert pose[:, 1] == pytest.approx(-pose[::-1, 1], abs=1e-3)


def _task(done: Done) -> None:
    assert done.names["observation"]["pose"].shape == (3,)
    assert done.names["truncated"] or done.names["terminated"]


def _gain(done: Done) -> None:
    offsets = dict(zip(done.names["table"]["gain"], done.names["table"]["offset"], strict=True))
    assert min(offsets, key=offsets.__getitem__) == 2.0


CHECKS: dict[str, Callable[[Done], None]] = {
    "Drive to points": _points,
    "Follow a wall": _follow,
    "Avoid obstacles": _avoid,
    "Dock at a beacon": _dock,
    "A drone takes off": _takes_off,
    "Wind on a drone": _wind,
    "A photo by a camera": _photo,
    "A film of a run": _film,
    "A point cloud from a depth camera": _cloud,
    "A map from a laser scanner": _map,
    "Write a log as CSV": _csv,
    "Record a run, and simulate it again": _record,
    "A run as a web page": _page,
    "Odometry that drifts": _odometry,
    "Spawn, move and delete objects": _spawn,
    "Stop at a contact": _contact,
    "Dominoes": _dominoes,
    "Pick something up": _pick,
    "An arm reaches for a point": _arm,
    "Try again from a saved state": _again,
    "An hour in seconds": _hour,
    "Sixteen robots at once, as arrays": _batch,
    "A task for reinforcement learning": _task,
    "Which gain is best?": _gain,
}
