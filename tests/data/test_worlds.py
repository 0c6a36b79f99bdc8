"""The indoor worlds for mapping, the meadow of the sandbox, and the initial viewpoint of each world."""

import math
from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

import morse
from morse.assets import find, load
from morse.builder import ATRV, Environment, FakeRobot, Hokuyo, Morsy, MotionVW, Pose
from morse.mathutils import Euler
from morse.scene import Scene, ShapeKind

WORLDS = (
    "sandbox",
    "apartment",
    "outdoors",
    "human_tut/tutorial_scene",
    "indoors-1/boxes",
    "indoors-1/indoor-1",
    "indoors-1/office",
    "indoors-1/warehouse",
    "laas/grande_salle",
    "land-1/buildings_1",
    "land-1/buildings_2",
    "land-1/rosace_1",
    "land-1/trees",
    "tum_kitchen/tum_kitchen",
)
#: in the office: the middle of the corridor's south side, a door in its wall, and a position without one; metres
CORRIDOR, WALL, DOOR, NO_DOOR = -3.2, -4.2, 12.5, 9.0
#: metres from the centre of the office to the inside of its outer walls, along X and Y
OFFICE = (10.5, 12.925, 8.925)


@cache
def scene_of(world: str, *, robot: Callable[[], object] = FakeRobot) -> Scene:
    """The scene of a world, for tests that only look at it."""

    def scene() -> None:
        robot()
        Environment(world)

    with morse.load(scene) as simulation:
        return simulation.context.scene


# --- the office ----------------------------------------------------------------------------------


def drive(x: float) -> float:
    """Drive south from the corridor of the office for eight seconds; returns the final y, metres."""

    def scene() -> None:
        robot = Morsy("robot")
        robot.translate(x=x, y=CORRIDOR)
        robot.rotate(z=-math.pi / 2)
        robot.append(MotionVW("motion"))
        robot.append(Pose("pose"))
        Environment("indoors-1/office")

    with morse.load(scene) as simulation:
        simulation.robot.motion.publish({"v": 0.4, "w": 0.0})
        simulation.step(480)
        pose = simulation.robot.pose.get()
        assert abs(pose["x"] - x) < 0.3
        return float(pose["y"])


def test_a_robot_drives_through_a_door_of_the_office() -> None:
    assert drive(DOOR) < WALL - 1.0


def test_a_wall_of_the_office_stops_a_robot() -> None:
    assert drive(NO_DOOR) > WALL


@pytest.mark.parametrize("world", ["indoors-1/office", "indoors-1/warehouse"])
def test_walls_and_racks_collide_as_boxes(world: str) -> None:
    nodes = [node for node in scene_of(world).nodes() if "Wall" in node.name or node.name.startswith("Rack")]
    assert len(nodes) >= 3
    for node in nodes:
        assert node.shapes
        assert {shape.kind for shape in node.shapes} == {ShapeKind.BOX}, node.name


@pytest.mark.parametrize("height", [0.3, 1.5])
def test_the_office_is_closed(height: float) -> None:
    """From the reception, all rays of a full scan hit something within the building."""

    def scene() -> None:
        robot = FakeRobot("robot")
        scan = Hokuyo("scan")
        scan.translate(z=height)
        scan.properties(scan_window=360.0, resolution=1.0, laser_range=30.0)
        robot.append(scan)
        Environment("indoors-1/office")

    with morse.load(scene) as simulation:
        simulation.step(30)
        points = np.array(simulation.robot.scan.get()["point_list"])
    assert len(points) >= 360
    middle, along, across = OFFICE
    # a ray without a hit ends at (0, 0, 0)
    assert np.all(np.hypot(points[:, 0], points[:, 1]) > 0.3)
    assert np.all(np.abs(points[:, 0] - middle) < along + 0.2)
    assert np.all(np.abs(points[:, 1]) < across + 0.2)


@pytest.mark.parametrize("world", ["indoors-1/boxes", "indoors-1/indoor-1"])
def test_the_hall_is_closed(world: str) -> None:
    """No robot falls from the floor of the hall: rays in all directions hit a wall above it."""

    def scene() -> None:
        robot = FakeRobot("robot")
        scan = Hokuyo("scan")
        scan.translate(z=3.0)
        scan.properties(scan_window=360.0, resolution=0.5, laser_range=60.0)
        robot.append(scan)
        Environment(world)

    with morse.load(scene) as simulation:
        simulation.step(30)
        points = np.array(simulation.robot.scan.get()["point_list"])
    assert len(points) >= 720
    # a ray without a hit ends at (0, 0, 0)
    assert np.all(np.hypot(points[:, 0], points[:, 1]) > 10.0)
    floor = next(node for node in scene_of(world).nodes() if node.name == "Ground")
    assert floor.mesh is not None
    assert np.all(np.abs(points[:, :2]) < np.abs(floor.mesh.vertices[:, :2]).max(axis=0))


def test_doors_of_the_office_are_wide_enough() -> None:
    """No gap in the south wall of the corridor is narrower than 1.4 m: Morsy, 1.2 m wide, passes."""
    walls = load(find("indoors-1/office", "environments"))
    node = next(node for node in walls.nodes() if node.name == "InnerWalls")
    assert node.mesh is not None
    points = node.mesh.vertices + np.array([row[3] for row in list(node.world_matrix())[:3]])
    triangles = points[node.mesh.triangles]
    at_knee = triangles[(triangles[:, :, 2].min(axis=1) < 0.3) & (triangles[:, :, 2].max(axis=1) > 0.3)]
    on_wall = at_knee[np.abs(at_knee[:, :, 1] - WALL).max(axis=1) < 0.08]
    spans = sorted((float(t[:, 0].min()), float(t[:, 0].max())) for t in on_wall)
    gaps, reach = [], spans[0][1]
    for start, end in spans:
        if start > reach + 1e-3:
            gaps.append(start - reach)
        reach = max(reach, end)
    assert len(gaps) == 5
    assert min(gaps) >= 1.4 - 1e-4


# --- the sandbox ---------------------------------------------------------------------------------


def test_the_sandbox_stands_on_a_meadow() -> None:
    """A robot outside the fence is on the ground, at the height of the floor inside."""

    def scene() -> None:
        robot = ATRV("robot")
        robot.translate(x=15.0, z=0.2)
        robot.append(Pose("pose"))
        Environment("sandbox")

    with morse.load(scene) as simulation:
        simulation.step(240)
        assert simulation.robot.pose.get()["z"] == pytest.approx(0.1, abs=0.03)


# --- initial viewpoints --------------------------------------------------------------------------


@pytest.mark.parametrize("world", WORLDS)
def test_the_view_of_a_world_begins_where_its_file_says(world: str) -> None:
    scene = scene_of(world)
    assert scene.find("CameraFP") is None, "the viewpoint is not an object of the world"
    camera = next(node for node in load(find(world, "environments")).nodes() if node.name == "CameraFP")
    view = scene.settings.view
    pose = camera.world_matrix()
    assert view.camera_location == pytest.approx([row[3] for row in list(pose)[:3]])
    turned, expected = Euler(view.camera_rotation).to_matrix(), pose.to_3x3()
    for row, other in zip(turned, expected, strict=True):
        assert list(row) == pytest.approx(list(other), abs=1e-6)


@pytest.mark.parametrize("world", WORLDS)
def test_what_the_view_shows_first_is_the_world_around_the_origin(world: str) -> None:
    """The camera is above the ground and looks down, and its axis intersects the floor of the world."""
    view = scene_of(world).settings.view
    x, y, z = view.camera_location
    ahead = -Euler(view.camera_rotation).to_matrix().col[2]
    assert z > 1.0
    assert ahead[2] < -0.1
    reach = z / -ahead[2]
    assert math.hypot(x + reach * ahead[0], y + reach * ahead[1]) < 15.0


def test_the_script_has_the_last_word_on_the_view() -> None:
    def scene() -> None:
        FakeRobot("robot")
        env = Environment("sandbox")
        env.set_camera_location([1.0, 2.0, 3.0])

    with morse.load(scene) as simulation:
        assert simulation.context.scene.settings.view.camera_location == (1.0, 2.0, 3.0)


# --- the room of the human tutorial ----------------------------------------------------------------


def test_a_robot_drives_from_the_room_of_the_tutorial_along_its_path() -> None:
    def scene() -> None:
        robot = ATRV()
        robot.translate(0.0, 0.0, 0.15)
        robot.append(MotionVW("motion"))
        robot.append(Pose("pose"))
        Environment("human_tut/tutorial_scene", fastmode=True)

    with morse.load(scene) as simulation:
        component = simulation.context.component
        component("robot.motion").local_data.update(v=2.0, w=0.0)
        simulation.step(8 * 60)
        place = component("robot.pose").local_data
    # through the doorway in the east, and 12 m on at the level of the floor, six metres above the meadow
    assert place["x"] == pytest.approx(16.0, abs=0.2)
    assert place["z"] == pytest.approx(0.1, abs=0.02)
    cup = next(node for node in scene_of("human_tut/tutorial_scene").nodes() if node.name == "CubeSelect")
    assert cup.properties["Graspable"]
