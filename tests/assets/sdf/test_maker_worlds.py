"""A robot drives in worlds that are written as makers write theirs."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import maker_worlds
import pytest

import morse

pytestmark = pytest.mark.long

#: tried each time: millimetres, faces that look down, a height map, tiles, a tunnel, old paths, frames
SHORT = (
    "aws_racetrack",
    "turtlebot3_autorace",
    "nasa_moon",
    "classic_city",
    "sim_tunnel",
    "aws_bookstore",
    "sim_frames",
)


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    return maker_worlds.write(tmp_path_factory.mktemp("makers"))


@pytest.fixture(scope="module")
def reach():
    spec = importlib.util.spec_from_file_location("reach", Path(__file__).parents[3] / "tools" / "reach.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    "name", [name if name in SHORT else pytest.param(name, marks=pytest.mark.slow) for name in maker_worlds.worlds()]
)
def test_a_robot_drives(reach, files, name) -> None:
    row = reach.measured("world", files[name])
    assert row["loads"], row.get("error")
    assert row["floor"] == (name not in maker_worlds.WITHOUT_FLOOR)
    # 4 s at 0.5 m/s, less the start
    assert not row["floor"] or row["drives"][0] > 1.0


#: heights of the floors at the origin, m
LEVELS = {"aws_racetrack": 0.0, "turtlebot3_autorace": 0.0, "sim_frames": 0.0, "classic_polyline": 0.0, "aws_roof": 0.0}


@pytest.mark.parametrize("name", LEVELS)
def test_the_floor_is_where_the_file_has_it(reach, files, name) -> None:
    def scene() -> None:
        from morse.builder import Environment

        Environment(str(files[name]), fastmode=True)

    with morse.load(scene) as sim:
        assert reach._floor(sim.world, 0.1, 0.2) == pytest.approx(LEVELS[name], abs=2e-3)
