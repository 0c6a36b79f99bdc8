"""The original data files of MORSE 1.4 as worlds and as objects.

They are in Debian's package morse-simulator-data (``usr/share/morse/data``) and are not part of this repository: the
environment variable ``MORSE_TEST_ORIGINAL_DATA`` is their directory.
"""

import json
import os
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from morse.assets.collision import resolve_shapes
from morse.builder.script import load_scene
from morse.physics import World
from morse.plugins.blend import read_blend
from morse.scene import Node
from morse.simulation.options import RunOptions

DATA = Path(os.environ.get("MORSE_TEST_ORIGINAL_DATA", ""))
FILES = sorted(path.relative_to(DATA).with_suffix("").as_posix() for path in DATA.rglob("*.blend")) if DATA.name else []
#: files that take a second or more; others like them are tried each time
LONG = {
    "actuators/pa_10",
    "environments/apartment",
    "environments/human_tut/tutorial_scene",
    "environments/land-1/buildings_2",
    "environments/land-1/rosace_1",
    "environments/land-1/trees",
    "environments/outdoors",
    "environments/tum_kitchen/tum_kitchen",
    "environments/water-1/water_scene",
    "props/furnitures",
    "robots/patrolbot",
    "robots/sa_hand-8-semi_ok",
}
GRAVITY = 9.81

pytestmark = pytest.mark.skipif(
    not FILES, reason="needs the files of Debian's morse-simulator-data; MORSE_TEST_ORIGINAL_DATA says where they are"
)


def chosen(*prefixes: str) -> list[Any]:
    """The files with those prefixes, as parameters of a test."""
    return [
        pytest.param(name, marks=pytest.mark.slow if name in LONG else ())
        for name in FILES
        if name.startswith(prefixes or "")
    ]


@dataclass(frozen=True)
class Fact:
    file: str
    object: str
    parent: str
    type: str
    physics: str
    bounds: str
    mass: str
    props: str


@cache
def facts() -> list[Fact]:
    lines = (Path(__file__).parent / "original_facts.tsv").read_text().splitlines()
    return [Fact(*line.split("\t")) for line in lines if not line.startswith(("#", "file\t"))]


def test_all_files_are_there() -> None:
    assert len(FILES) == 50
    assert {fact.file for fact in facts()} <= set(FILES)


@pytest.mark.parametrize("name", chosen())
def test_objects_have_the_bodies_masses_and_properties_of_the_files(name: str) -> None:
    nodes: dict[str, Node] = {node.name: node for node in read_blend(DATA / f"{name}.blend").nodes()}
    for fact in facts():
        if fact.file != name:
            continue
        node = nodes[fact.object]
        assert (node.parent.name if node.parent else "") == fact.parent
        assert node.kind.value == fact.type
        assert node.body.type.value == fact.physics, fact.object
        assert (node.body.bounds.value if node.body.bounds else "") == fact.bounds, fact.object
        if fact.mass:
            assert node.body.mass == pytest.approx(float(fact.mass), rel=0.01)
        for key, value in json.loads(fact.props or "{}").items():
            assert node.properties[key] == value, (fact.object, key)


def world_of(tmp_path: Path, *lines: str) -> World:
    script = tmp_path / "scene.py"
    script.write_text("\n".join(["from morse.builder import *", *lines]))
    scene = load_scene(RunOptions(str(script), view="none"))
    resolve_shapes(scene)
    return World(scene)


def settle(world: World) -> None:
    """Simulate 5 s: no body may gain energy, whether it rests, falls or overlaps."""
    bodies = [obj for obj in world.objects() if obj.is_dynamic and obj.parent is None]
    start = {obj.name: obj.worldPosition.z for obj in bodies}
    for _ in range(300):
        world.step()
    assert np.isfinite(world.data.qpos).all()
    for obj in bodies:
        energy = 0.5 * obj.worldLinearVelocity.length**2 + GRAVITY * (obj.worldPosition.z - start[obj.name])
        assert energy < 1.0 * GRAVITY, f"{obj.name} flies: as if it had been lifted by {energy / GRAVITY:.1f} m"


@pytest.mark.parametrize("name", chosen())
def test_a_file_is_a_world(tmp_path: Path, name: str) -> None:
    world = world_of(
        tmp_path, "robot = FakeRobot()", "robot.translate(z=100)", f"env = Environment({str(DATA / name)!r})"
    )
    settle(world)


@pytest.mark.parametrize("name", chosen("actuators", "props", "robots", "sensors"))
def test_a_file_is_a_passive_object(tmp_path: Path, name: str) -> None:
    world = world_of(
        tmp_path,
        "robot = FakeRobot()",
        "robot.translate(z=100)",
        f"thing = PassiveObject({str(DATA / name)!r})",
        "thing.translate(z=1.0)",
        "env = Environment('empty')",
    )
    settle(world)
    assert np.isfinite(world.game_object("thing").worldPosition).all()


@pytest.mark.parametrize(("x", "ends_at"), [(-2.2, 2.6), (-3.4, 1.33)])
def test_a_robot_drives_through_the_door_of_a_flat_and_not_through_its_wall(
    tmp_path: Path, x: float, ends_at: float
) -> None:
    # a wall from y = 1.9 to 2.0 with a door between x = -2.7 and -1.7; the robot is 1.15 m long
    world = world_of(
        tmp_path,
        "robot = ATRV()",
        f"robot.translate({x}, 0.6, 0.12)",
        "robot.rotate(z=math.pi / 2)",
        f"env = Environment({str(DATA / 'environments/apartment')!r})",
    )
    robot = world.game_object("robot")
    for _ in range(240):
        robot.drive((0.5, 0.0, 0.0), (0.0, 0.0, 0.0), ground=True)
        world.step()
    assert robot.worldPosition.y == pytest.approx(ends_at, abs=0.05)
    assert robot.worldPosition.z == pytest.approx(0.1, abs=0.05)
