"""The editor of the page: models are added, moved and deleted, changes undone, and the scene saved in its script."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from editor_desk import MODELS, SCENE, Desk
from view_pages import Client, fetch, toasts
from websockets.exceptions import ConnectionClosed, InvalidStatus

import morse
from morse.builder.editing.changes import Changes
from morse.builder.editing.writing import changed_script
from morse.core.classes.project_imports import ProjectImports
from morse.launch.model_pictures import models
from morse.scene.extent import visible_extent
from morse.viewer.catalog import Catalog
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from playwright.sync_api import Page


def test_a_scene_is_changed_and_saved_in_its_script(desk: Desk, tmp_path: Path) -> None:
    assert desk.do("add_model", model="props/crates#small_crate", position=[3, 1, 0], yaw=0.5) == "small_crate"
    assert desk.do("add_model", model="VideoCamera", position=[0.2, 0, 1], robot="robot") == "robot.video_camera"
    desk.do("teleport", node="robot", position=[2, 2, 0.1], quaternion=[1, 0, 0, 0])
    assert "small_crate" in desk.names()
    shown = desk.do("save_scene", write=False)
    assert "+small_crate.rotate(z=0.5)" in shown["difference"].splitlines()
    assert (tmp_path / "scene.py").read_text() == SCENE
    assert desk.do("save_scene", write=True)["path"] == str(tmp_path / "scene.py")
    text = (tmp_path / "scene.py").read_text()
    assert "# my robot\nrobot = ATRV()\nrobot.translate(2.0, 2.0" in text
    assert "  # by the door\n" in text
    with morse.load(tmp_path / "scene.py") as again:
        crate, robot = again.scene.find("small_crate"), again.scene.find("robot")
        assert crate is not None
        assert robot is not None
        assert crate.location[:2] == pytest.approx([3, 1])
        assert crate.rotation_euler == pytest.approx([0, 0, 0.5])
        assert robot.location == pytest.approx([2, 2, 0.1], abs=1e-3)
        assert "robot.video_camera" in again.context.components


def test_changes_after_a_save_are_saved_again_but_not_over_the_work_of_others(desk: Desk, tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    desk.do("add_model", model="Morsy", position=[3, 1, 0])
    desk.do("save_scene", write=True)
    desk.do("add_model", model="Morsy", position=[5, 1, 0])
    desk.do("save_scene", write=True)
    assert script.read_text().count("Morsy()") == 2
    script.write_text(SCENE + "# mine\n")
    answer = desk.ask("save_scene", write=True)
    assert not answer["ok"]
    assert "scene.py was changed since" in answer["error"]
    assert script.read_text() == SCENE + "# mine\n"


LOOP = """from morse.builder import *

for number in range(3):
    robot = ATRV()
    robot.translate(0, 3 * number)
    pose = Pose()
    robot.append(pose)
    box = PassiveObject("props/crates", object_name="small_crate")
    box.translate(5, 3 * number)
    box.name = f"box{number}"

env = Environment("empty")
"""


def setting(desk: Desk, method: str) -> Any:
    desk._client.send("list_settings", component="simulation")
    settings = desk._wait("component_settings", component="simulation")["settings"]
    return next(one["arguments"][0]["value"] for one in settings if one["method"] == method)


def test_settings_of_the_environment_are_written_and_loaded(desk: Desk, tmp_path: Path) -> None:
    def put(method: str, value: object, **more: object) -> None:
        desk.do("configure", component="simulation", method=method, values={"": value}, **more)

    assert setting(desk, "set_gravity") == 9.81
    put("set_gravity", 1.62)
    put("set_gravity", 3.7)
    assert setting(desk, "set_gravity") == 3.7
    put("set_camera_location", [1.0, -8.0, 4.0])
    put("set_time_strategy", "FixedSimulationStep")
    put("set_horizon_color", [0.5, 0.3, 0.2])
    put("set_daylight", 0.5)
    put("add_default_interface", "mqtt")
    put("simulator_frequency", 100)
    desk.do("undo_change")
    put("set_daylight", 0.5, remove=True)
    desk.do("save_scene", write=True)
    text = (tmp_path / "scene.py").read_text()
    assert text.startswith(SCENE)
    assert text[len(SCENE) :].splitlines() == [
        "env.set_gravity(3.7)",
        "env.set_camera_location([1.0, -8.0, 4.0])",
        "env.set_time_strategy(TimeStrategies.FixedSimulationStep)",
        "env.set_horizon_color([0.5, 0.3, 0.2])",
        "env.add_default_interface('mqtt')",
    ]
    with morse.load(tmp_path / "scene.py") as again:
        settings = again.scene.settings
        assert settings.gravity == 3.7
        assert settings.view.camera_location == (1.0, -8.0, 4.0)
        assert settings.time_strategy.name == "FixedSimulationStep"
        assert settings.view.horizon_color == (0.5, 0.3, 0.2)


def test_settings_that_count_from_the_next_start_on_are_loaded(desk: Desk, tmp_path: Path) -> None:
    def put(method: str, remove: bool = False, **values: object) -> None:
        named = {name.rstrip("_"): value for name, value in values.items()}
        desk.do("configure", component="simulation", method=method, values=named, remove=remove)

    put("set_seed", _=7)
    put("set_start_date", _="2026-06-21")
    put("set_physics_step_sub", _=8)
    put("set_auto_start", _=False)
    put("show_physics", _=True)
    # of all sensors
    put("alter", _="Noise", pos_std=0.5)
    put("alter", _="NED")
    # the values of several calls stand in one, and are taken back together
    put("properties", latitude=45.0)
    put("properties", remove=True)
    put("properties", longitude=5.5)
    put("properties", latitude=43.6, Temperature=30.0)
    assert "properties" in desk.do("undo_change")
    desk.do("redo_change")
    desk.do("save_scene", write=True)
    lines = (tmp_path / "scene.py").read_text()[len(SCENE) :].splitlines()
    assert {"env.alter('Noise', pos_std=0.5)", "env.alter('NED')"} <= {*lines}
    assert lines[-1] == "env.properties(longitude=5.5, latitude=43.6, Temperature=30.0)"
    with morse.load(tmp_path / "scene.py") as again:
        settings = again.scene.settings
        assert (settings.seed, settings.auto_start, settings.physics_steps) == (7, False, 8)
        assert settings.start_time == 1782000000  # 2026-06-21 00:00 UTC
        place = again.scene.properties
        assert settings.view.show_physics
        assert (place["longitude"], place["latitude"], place["Temperature"]) == (5.5, 43.6, 30.0)


@pytest.mark.parametrize(
    ("method", "values"),
    [
        ("set_seed", {"": -1}),
        ("set_seed", {"": 1.5}),
        ("set_start_date", {"": "yesterday"}),
        ("set_start_date", {"": 3}),
        ("set_auto_start", {"": "yes"}),
        ("alter", {"": "Nois"}),
        ("alter", {"": 1}),
        ("alter", {"pos_std": 0.5}),
        ("alter", {"": "Noise", "pos_std": "much"}),
        ("alter", {"": "Noise", "classpath": "os.system"}),
        ("properties", {}),
        ("properties", {"latitude": "north"}),
        ("properties", {"latitude": float("1e300")}),
        ("properties", {"Weather": 1.0}),
    ],
)
def test_what_is_no_setting_of_the_environment_changes_nothing(desk: Desk, method: str, values: object) -> None:
    answer = desk.ask("configure", component="simulation", method=method, values=values)
    assert not answer["ok"]
    assert answer["error"]
    assert desk.do("save_scene", write=False)["difference"] == ""


def test_settings_of_the_environment_take_effect_at_once(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(
        SCENE.replace("robot = ATRV()", "robot = Cube()\nrobot.set_rigid_body()").replace("2.0)", "2.0, 60.0)")
        + "env.set_daylight(0.9)\n"
    )
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        cube = simulation.world.objects_by_name["robot"]

        def put(method: str, more: bool = False, **values: object) -> None:
            named = {name.rstrip("_"): value for name, value in values.items()}
            desk.do("configure", component="simulation", method=method, values=named, remove=more)

        def acceleration() -> float:
            speed = cube.worldLinearVelocity.z
            simulation.step(6)
            return float((cube.worldLinearVelocity.z - speed) * 10)

        assert acceleration() == pytest.approx(-9.81, abs=0.3)
        time, height = simulation.clock.time, cube.worldPosition.z
        put("set_gravity", _=1.62)
        # neither time nor state are lost
        assert simulation.clock.time - time < 1.0
        assert height - cube.worldPosition.z < 10.0
        assert acceleration() == pytest.approx(-1.62, abs=0.3)
        desk.do("undo_change")
        assert acceleration() == pytest.approx(-9.81, abs=0.3)
        desk.do("redo_change")
        put("set_gravity", more=True, _=1.62)
        assert acceleration() == pytest.approx(-9.81, abs=0.3)
        settings = simulation.scene.settings
        put("set_daylight", _=0.2)
        put("set_mist_settings", enable=True, start=3.0, depth=9.0)
        assert settings.view.daylight == 0.2
        assert settings.view.mist is not None
        assert (settings.view.mist.start, settings.view.mist.depth) == (3.0, 9.0)
        put("set_camera_location", _=[1.0, 2.0, 3.0])
        assert desk._wait("viewpoint")["location"] == [1.0, 2.0, 3.0]
        simulation.restart()
        simulation.step(1)
        assert settings.view.daylight == 0.2
        desk.do("save_scene", write=True)
        with morse.load(script) as again:
            assert again.scene.settings.view == settings.view
        for _ in range(3):
            desk.do("undo_change")
        assert (settings.view.daylight, settings.view.mist) == (0.9, None)


def test_settings_of_the_environment_come_after_those_of_the_script() -> None:
    script = SCENE + "env.set_gravity(1.0)\nenv.show(rays=True)\n"
    assert changed_script(script, Changes(settings=["set_gravity(2.0)"])) == script + "env.set_gravity(2.0)\n"
    with pytest.raises(ValueError, match="by hand"):
        changed_script(SCENE.replace("env = ", ""), Changes(settings=["set_gravity(2.0)"]))


@pytest.mark.parametrize(
    ("method", "values"),
    [
        ("set_gravity", {"": "much"}),
        ("set_gravity", {"": 1e300}),
        ("set_gravity", {"": "9.8"}),
        ("set_mist_settings", {}),
        ("set_mist_settings", {"": True}),
        ("set_mist_settings", {"enable": "yes"}),
        ("set_mist_settings", {"start": -1}),
        ("set_mist_settings", {"start": True}),
        ("set_mist_settings", {"falloff": "LINEAR"}),
        ("set_mist_settings", {"start": float("1e12")}),
        ("set_gravity", {"": True}),
        ("set_gravity", {}),
        ("set_gravity", {"": 9.8, "x": 1}),
        ("set_gravity", {"gravity": 9.8}),
        ("simulator_frequency", {"": 0}),
        ("set_daylight", {"": 7}),
        ("set_camera_location", {"": [1, 2]}),
        ("set_camera_location", {"": [1, 2, [3]]}),
        ("set_camera_location", {"": {"a": 1}}),
        ("set_horizon_color", {"": "red"}),
        ("set_time_strategy", {"": "x); import os; os.system('id'"}),
        ("add_default_interface", {"": "nobody"}),
        ("add_default_interface", {"": "mqtt\nimport os"}),
        ("add_default_interface", {"": 5}),
        ("save", {"": "/tmp/x"}),
        ("__init__", {"": "empty"}),
        ("frequency", {"": 5.0}),
        ("properties", {"": 5.0}),
    ],
)
def test_what_is_no_setting_of_the_environment_is_refused(desk: Desk, method: str, values: dict[str, Any]) -> None:
    answer = desk.ask("configure", component="simulation", method=method, values=values)
    assert not answer["ok"]
    assert answer["error"]
    assert desk.do("save_scene", write=False)["difference"] == ""


def test_changes_of_one_group_are_undone_and_made_again_together(desk: Desk) -> None:
    crate = "props/crates#small_crate"
    for x in (3, 5):
        desk.do("add_model", model=crate, position=[x, 1, 0])
    for node in ("small_crate", "small_crate_2"):
        desk.do("teleport", node=node, position=[7, 7, 1], quaternion=[1, 0, 0, 0], group=5)
    assert {desk.do("duplicate_object", node=node, group=6) for node in ("small_crate", "small_crate_2")} == {
        "small_crate_3",
        "small_crate_4",
    }
    for node in ("small_crate", "small_crate_2"):
        desk.do("delete_object", node=node, group=7)
    assert {"small_crate", "small_crate_2"}.isdisjoint(desk.names())
    desk.do("undo_change")
    assert {"small_crate", "small_crate_2", "small_crate_3", "small_crate_4"} <= desk.names()
    desk.do("undo_change")
    assert {"small_crate_3", "small_crate_4"}.isdisjoint(desk.names())
    assert "1 more" in desk.do("undo_change")
    positions = [desk.simulation.world.objects_by_name[name].position[0] for name in ("small_crate", "small_crate_2")]
    assert positions == pytest.approx([3, 5], abs=0.01)
    for _ in range(3):
        desk.do("redo_change")
    assert {"small_crate", "small_crate_2"}.isdisjoint(desk.names())
    # without a group, each is undone alone
    for node in ("small_crate_3", "small_crate_4"):
        desk.do("delete_object", node=node)
    desk.do("undo_change")
    assert "small_crate_3" not in desk.names()
    assert "small_crate_4" in desk.names()


def test_an_object_that_was_added_is_scaled_saved_and_loaded_again(desk: Desk, tmp_path: Path) -> None:
    desk.do("add_model", model="Cube", position=[3, 1, 0])

    def height() -> float:
        corners = desk.simulation.world.objects_by_name["cube"].node.scale
        return float(corners[2])

    desk.do("scale_object", node="cube", factors=[1, 1, 2])
    desk.do("scale_object", node="cube", factors=[1, 1, 1.5])
    assert height() == pytest.approx(3.0)
    desk.do("undo_change")
    assert height() == pytest.approx(2.0)
    desk.do("redo_change")
    desk.do("save_scene", write=True)
    assert "cube.scale = (1.0, 1.0, 3.0)" in (tmp_path / "scene.py").read_text()
    with morse.load(tmp_path / "scene.py") as again:
        cube = again.scene.find("cube")
        assert cube is not None
        assert cube.scale == pytest.approx([1, 1, 3])
    desk.simulation.start_anew()
    desk.simulation.step(2)
    assert height() == pytest.approx(3.0)


def test_the_new_shape_of_what_is_scaled_collides(desk: Desk) -> None:
    desk.do("add_model", model="props/crates#small_crate", position=[3, 1, 0])
    desk.do("scale_object", node="small_crate", factors=[2, 2, 4])
    desk.do("add_model", model="props/crates#small_crate", position=[3, 1, 4])
    desk.simulation.step(240)
    upper = desk.simulation.world.objects_by_name["small_crate_2"]
    corners = visible_extent(upper.node)
    assert corners is not None
    height = float(corners[1][2] - corners[0][2])
    assert upper.position[2] == pytest.approx(4 * height, abs=0.1)


@pytest.mark.parametrize("factors", [[1, 1, 1000], [1e-4, 1, 1], [1e6, 1e6, 1e6]])
def test_a_size_out_of_bounds_changes_nothing(desk: Desk, factors: list[float]) -> None:
    desk.do("add_model", model="Cube", position=[3, 1, 0])
    assert not desk.ask("scale_object", node="cube", factors=factors)["ok"]
    cube = desk.simulation.scene.find("cube")
    assert cube is not None
    assert cube.scale == pytest.approx([1, 1, 1])


@pytest.mark.parametrize("factors", [[0, 1, 1], [1, -1, 1], [1, 1], [1e308, 1, 1], ["2", 1, 1], None])
def test_what_is_no_size_closes_the_connection(desk: Desk, factors: object) -> None:
    with pytest.raises(ConnectionClosed, match="Not understood"):
        desk.ask("scale_object", node="robot", factors=factors)


def test_what_was_not_added_here_is_not_scaled(desk: Desk) -> None:
    for node in ("robot", "nobody"):
        assert not desk.ask("scale_object", node=node, factors=[2, 2, 2])["ok"]
    desk.do("add_model", model="Morsy", position=[3, 1, 0])
    assert "size of the real one" in desk.ask("scale_object", node="morsy", factors=[2, 2, 2])["error"]
    assert "morsy" in desk.names()


def test_a_property_of_a_robot_that_was_added_outlives_a_restart(desk: Desk) -> None:
    desk.do("add_model", model="Morsy", position=[3, 1, 0])
    desk.do("set_property", component="morsy", name="NoGravity", value=True)
    desk.simulation.start_anew()
    desk.simulation.step(2)
    assert desk.simulation.context.robots["morsy"]._no_gravity is True


def test_nothing_is_left_to_save_after_a_save_until_something_changes(desk: Desk) -> None:
    desk.do("add_model", model="Morsy", position=[3, 1, 0])
    desk.unsaved(1)
    desk.do("save_scene", write=True)
    desk.unsaved(0)
    # the file has a robot that the world has no longer
    desk.do("undo_change")
    desk.unsaved(1)
    desk.do("save_scene", write=True)
    desk.unsaved(0)


def test_what_a_loop_creates_is_deleted_by_its_name(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(LOOP)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.do("delete_object", node="box1")
        desk.do("delete_object", node="robot_001")
        desk.do("save_scene", write=True)
    assert 'bpymorse.delete("robot_001")\n' in script.read_text()
    with morse.load(script) as again:
        roots = {root.name for root in again.scene.roots}
        assert {*again.context.components} == {"robot.pose", "robot_002.pose"}
    assert {"box0", "box2", "robot", "robot_002"} <= roots
    assert not {"box1", "robot_001"} & roots


def test_robots_and_sensors_of_the_project_are_in_the_list(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for kind, base in (("robots", "FakeRobot"), ("sensors", "Pose")):
        folder = tmp_path / "src" / "my_sim" / "builder" / kind
        folder.mkdir(parents=True)
        folder.joinpath("__init__.py").write_text(
            f"from morse.builder import *\n\n\nclass My{kind[:-1].title()}({base}):\n    pass\n"
        )
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    sources = [str(tmp_path / "src")]
    with ProjectImports(sources):
        own = [model._asdict() for model in models(sources) if ":" in model.kind]
    assert [(model["name"], model["group"]) for model in own] == [("MyRobot", "robots"), ("MySensor", "sensors")]
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(own))
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.models()
        desk.do("add_model", model="my_sim.builder.robots:MyRobot", position=[3, 1, 0])
        desk.do("add_model", model="my_sim.builder.sensors:MySensor", position=[0, 0, 1], robot="robot")
        assert "my_robot" in simulation.context.robots
        desk.do("save_scene", write=True)
    with morse.load(script) as again:
        assert {*again.context.robots} == {"robot", "my_robot"}
        assert "robot.my_sensor" in again.context.components


def test_components_act_and_measure_at_once(desk: Desk, tmp_path: Path) -> None:
    simulation = desk.simulation
    simulation.step(30)
    tick = simulation.ticks
    assert desk.do("add_model", model="IMU", position=None, robot="robot") == "robot.imu"
    assert desk.do("add_model", model="MotionVW", robot="robot") == "robot.motion_vw"
    assert simulation.ticks < tick + 600  # time goes on
    imu = simulation.scene.find("robot.imu")
    assert imu is not None
    assert imu.location[2] > 0.3  # on the robot, not in it
    body = simulation.context.robots["robot"].bge_object
    desk.do("command", component="robot.motion_vw", fields={"v": 1.0, "w": 0.0})
    x = body.worldPosition.x
    simulation.step(60)
    assert body.worldPosition.x == pytest.approx(x + 1.0, abs=0.1)
    assert simulation.robot.imu.get()["linear_acceleration"][2] == pytest.approx(9.81, abs=0.1)
    desk.do("save_scene", write=True)
    with morse.load(tmp_path / "scene.py") as again:
        assert {*again.context.components} == {"robot.imu", "robot.motion_vw"}
        there = again.scene.find("robot.imu")
        assert there is not None
        assert there.location == pytest.approx(imu.location)


def test_what_is_added_without_a_place_stands_beside_what_is_there(desk: Desk) -> None:
    scene = desk.simulation.scene
    robot = scene.find("robot")
    assert robot is not None
    box = visible_extent(robot)
    assert box is not None
    top = [1.0, 2.0, float(box[1][2])]  # the middle of the view looks at the robot
    kinds = ["props/crates#small_crate", "Cube", "Morsy", "props/crates#small_crate"]
    names = ["robot", *(desk.do("add_model", model=kind, position=top, beside=True) for kind in kinds)]
    boxes = [found for name in names if (found := visible_extent(scene.find(name))) is not None]
    assert len(boxes) == 5
    for number, (low, high) in enumerate(boxes):
        assert low[2] == pytest.approx(0.0, abs=0.05), names[number]
        assert abs((low + high)[:2] / 2 - top[:2]).max() < 6.0  # in view
        for other_low, other_high in boxes[:number]:
            assert (low[:2] > other_high[:2]).any() or (high[:2] < other_low[:2]).any()
    # where one points is where it goes
    there = desk.do("add_model", model="Cube", position=top)
    assert scene.find(there).location[:2] == pytest.approx(top[:2])


def test_what_is_added_without_a_place_stands_beside_the_furniture_of_the_world(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(MODELS))
    script = tmp_path / "scene.py"
    script.write_text(SCENE.replace('"empty"', '"indoors-1/indoor-1"'))
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.models()
        for thing in ("Rolling_Chair.001", "RedBox"):
            root = simulation.scene.find(thing)
            assert root is not None
            box = visible_extent(root)
            assert box is not None
            middle = (box[0] + box[1]) / 2
            name = desk.do("add_model", model="Morsy", position=[*middle[:2], float(box[1][2])], beside=True)
            simulation.step(60)
            node = simulation.scene.find(name)
            assert node is not None
            assert node.location == pytest.approx((*node.location[:2], 0.0), abs=0.05)
            assert node.rotation_euler[:2] == pytest.approx((0.0, 0.0), abs=0.05)  # it has not been thrown over


def test_solids_lamps_and_cameras_are_added(desk: Desk, tmp_path: Path) -> None:
    for kind in ("Cube", "Spot", "Camera"):
        assert desk.do("add_model", model=kind, position=[3, 1, 0]) == kind.lower()
    desk.do("save_scene", write=True)
    with morse.load(tmp_path / "scene.py") as again:
        cube, spot, camera = (again.scene.find(name) for name in ("cube", "spot", "camera"))
        assert cube is not None
        assert cube.mesh is not None
        assert spot is not None
        assert spot.light is not None
        assert spot.location[2] > 1.0  # not in the ground
        assert camera is not None
        assert camera.camera is not None


OWN = """from morse.builder import *

robot = ATRV()
pose = Pose()
robot.append(pose)
camera = VideoCamera()  # eye
camera.translate(0.2, 0, 1)
robot.append(camera)

env = Environment("empty")
"""


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    """The editor of a scene whose robot has components."""
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(MODELS))
    script = tmp_path / "scene.py"
    script.write_text(OWN)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.models()
        yield desk


def test_a_component_of_the_script_is_deleted_and_comes_back(own: Desk, tmp_path: Path) -> None:
    own.do("delete_object", node="robot.camera")
    assert {*own.simulation.context.components} == {"robot.pose"}
    own.do("save_scene", write=True)
    text = (tmp_path / "scene.py").read_text()
    assert "camera" not in text
    assert "robot.append(pose)\n" in text
    assert own.do("undo_change") == "robot.camera was deleted"
    camera = own.simulation.scene.find("robot.camera")
    assert camera is not None
    assert [*camera.location] == [0.2, 0.0, 1.0]
    own.do("save_scene", write=True)
    assert (tmp_path / "scene.py").read_text() == OWN
    assert own.do("redo_change") == "robot.camera was deleted"
    assert {*own.simulation.context.components} == {"robot.pose"}


def test_the_script_is_shown_with_the_lines_of_each_object(own: Desk) -> None:
    own.do("add_model", model="IMU", robot="robot")
    shown = own.do("show_script")
    lines = shown["text"].split("\n")
    assert shown["file"] == "scene.py"
    of = {name: [lines[number - 1] for number in numbers] for name, numbers in shown["lines"].items()}
    assert of["robot"][0] == "robot = ATRV()"
    assert of["robot.camera"] == ["camera = VideoCamera()  # eye", "camera.translate(0.2, 0, 1)"]
    assert of["robot.imu"][0] == "imu = IMU()"
    assert own.do("save_scene", write=True)["difference"]
    assert own.do("show_script") == shown


def test_components_of_a_loop_are_deleted_by_name(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(LOOP)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.do("delete_object", node="robot_001.pose")
        desk.do("save_scene", write=True)
    with morse.load(script) as again:
        assert {*again.context.components} == {"robot.pose", "robot_002.pose"}


def test_settings_take_effect_and_are_written(own: Desk, tmp_path: Path) -> None:
    components = own.simulation.context.components
    own.do("set_property", component="robot.camera", name="cam_width", value=64)
    own.do("configure", component="robot.pose", method="frequency", values={"": 20.0})
    own.do("configure", component="robot.pose", method="alter", values={"": "Noise", "pos_std": 0.5})
    own.do("configure", component="robot.pose", method="add_stream", values={"": "socket"})
    assert components["robot.pose"].frequency == 20.0
    own.simulation.step(30)
    true = own.simulation.context.robots["robot"].bge_object.worldPosition
    assert abs(own.simulation.robot.pose.get()["x"] - true.x) > 1e-4
    assert components["robot.camera"].image_width == 64
    shown = own.do("save_scene", write=True)["difference"].splitlines()
    added = [line[1:] for line in shown if line.startswith("+")]
    assert added == [
        "pose.frequency(20.0)",
        "pose.alter('Noise', pos_std=0.5)",
        "pose.add_stream('socket')",
        "camera.properties(cam_width=64)",
    ]
    with morse.load(tmp_path / "scene.py") as again:
        assert again.context.components["robot.pose"].frequency == 20.0
        assert len(again.context.components["robot.pose"].output_modifiers) == 1
        assert again.context.components["robot.camera"].image_width == 64
    own.simulation.restart()
    own.simulation.step(2)
    assert own.simulation.context.components["robot.pose"].frequency == 20.0
    own.do("configure", component="robot.pose", method="alter", values={"": "Noise"}, remove=True)
    assert own.simulation.context.components["robot.pose"].output_modifiers == []
    for _ in range(4):
        own.do("undo_change")
    assert own.simulation.context.components["robot.pose"].frequency != 20.0
    own.do("undo_change")
    assert own.simulation.context.components["robot.camera"].image_width == 256
    assert (tmp_path / "scene.py").read_text().count("pose.") == 3
    own.do("save_scene", write=True)
    assert (tmp_path / "scene.py").read_text() == OWN


def test_a_robot_is_duplicated_with_its_components_and_settings(desk: Desk, tmp_path: Path) -> None:
    desk.do("add_model", model="Morsy", position=[3, 1, 0])
    desk.do("add_model", model="IMU", robot="morsy")
    desk.do("configure", component="morsy.imu", method="frequency", values={"": 10.0})
    twin = desk.do("duplicate_object", node="morsy")
    parts = [name for name in desk.simulation.context.components if name.startswith(f"{twin}.")]
    assert [desk.simulation.context.components[name].frequency for name in parts] == [10.0]
    desk.simulation.step(60)
    a, b = (desk.simulation.context.robots[name].bge_object.worldPosition for name in ("morsy", twin))
    assert abs(a.y - b.y) > 0.5
    desk.do("save_scene", write=True)
    with morse.load(tmp_path / "scene.py") as again:
        assert {*again.context.components} == {*desk.simulation.context.components}
    desk.do("undo_change")
    assert {*desk.simulation.context.robots} == {"robot", "morsy"}
    desk.do("redo_change")
    assert {*desk.simulation.context.robots} == {"robot", "morsy", twin}
    assert parts[0] in desk.simulation.context.components


def test_a_deleted_robot_comes_back_with_what_was_added_and_set(desk: Desk) -> None:
    desk.do("add_model", model="IMU", robot="robot")
    desk.do("configure", component="robot.imu", method="frequency", values={"": 10.0})
    desk.do("delete_object", node="robot")
    assert not desk.simulation.context.components
    desk.do("undo_change")
    assert desk.simulation.context.components["robot.imu"].frequency == 10.0


def test_every_change_is_undone(desk: Desk) -> None:
    before = desk.names()
    place = [*desk.simulation.scene.find("robot").location]
    for x in (1.5, 2.0, 2.5):
        first = x == 1.5
        desk.do("teleport", node="robot", position=[x, 2, 0.2], quaternion=[0.8, 0, 0, 0.6], first=first)
    desk.do("add_model", model="Morsy", position=[5, 1, 0])
    desk.do("delete_object", node="robot")
    assert desk.names() == (before - {"robot"}) | {"morsy"}
    assert desk.do("undo_change") == "robot was deleted"
    assert desk.names() == before | {"morsy"}
    assert "robot" in desk.simulation.context.robots
    assert desk.do("undo_change") == "morsy was added"
    assert desk.names() == before
    assert desk.do("undo_change") == "robot was moved"
    assert [*desk.simulation.context.robots["robot"].bge_object.worldPosition][:2] == pytest.approx(place[:2], abs=0.01)
    assert not desk.ask("undo_change")["ok"]
    assert desk.do("save_scene", write=False)["difference"] == ""


def test_changes_outlast_a_restart(desk: Desk) -> None:
    desk.do("add_model", model="Morsy", position=[5, 1, 0])
    desk.do("delete_object", node="robot")
    desk.simulation.restart()
    desk.simulation.step(2)
    assert "morsy" in desk.names()
    assert "robot" not in desk.names()


@pytest.mark.parametrize(
    ("kind", "fields", "why"),
    [
        ("add_model", {"model": "/etc/passwd", "position": [0, 0, 0]}, "no model"),
        ("add_model", {"model": "VideoCamera", "position": [0, 0, 0]}, "drop a sensor or an actuator on a robot"),
        ("delete_object", {"node": "nothing"}, "no object 'nothing'"),
        ("redo_change", {}, "no change to make again"),
        ("add_model", {"model": "IMU", "position": None, "robot": "env"}, "on a robot"),
        ("duplicate_object", {"node": "robot"}, "copy its lines in the script"),
        (
            "configure",
            {"component": "robot", "method": "frequency", "values": {"": 10}},
            "no sensor or actuator 'robot'",
        ),
        ("configure", {"component": "robot.imu", "method": "frequency", "values": {"": -1}}, "frequency"),
        ("configure", {"component": "robot.imu", "method": "frequency", "values": {"": "\n"}}, "frequency"),
        ("configure", {"component": "robot.imu", "method": "alter", "values": {"": "os.system"}}, "installed"),
        ("configure", {"component": "robot.imu", "method": "alter", "values": {"classpath": "os.system"}}, "installed"),
        ("configure", {"component": "robot.imu", "method": "add_stream", "values": {"": "x" * 500}}, "no middleware"),
        ("configure", {"component": "robot.imu", "method": "exec", "values": {"": "1"}}, "not a setting"),
        (
            "configure",
            {"component": "robot.imu", "method": "level", "values": {"a b": "1"}},
            "not a name of an argument",
        ),
        ("configure", {"component": "robot.imu", "method": "noise", "values": {"gaussian": "x"}}, "number"),
        ("configure", {"component": "robot.imu", "method": "delay", "values": {}, "remove": True}, "was not set"),
    ],
)
def test_impossible_changes_are_refused(
    desk: Desk, kind: str, fields: dict[str, Any], why: str, tmp_path: Path
) -> None:
    desk.do("add_model", model="IMU", robot="robot")
    answer = desk.ask(kind, **fields)
    assert not answer["ok"]
    assert why in answer["error"]
    # nothing has changed: the component is there as before
    assert {*desk.simulation.context.components} == {"robot.imu"}
    desk.do("undo_change")
    assert not desk.simulation.context.components
    assert desk.do("save_scene", write=False)["difference"] == ""


def test_pages_from_elsewhere_cannot_edit(desk: Desk, tmp_path: Path) -> None:
    with pytest.raises(InvalidStatus):
        Client(desk.simulation.view.url, origin="http://elsewhere.example")
    with Client(desk.simulation.view.url) as second:
        second.send("save_scene", request=1, write=True)
        refusal = second.expect("answer", request=1)
    assert not refusal["ok"]
    assert "another page drives" in refusal["error"]
    assert (tmp_path / "scene.py").read_text() == SCENE


@pytest.mark.slow
def test_the_models_have_pictures(tmp_path: Path) -> None:
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        desk = Desk(simulation, client)
        kinds = {model["kind"] for model in desk.models()}
        assert {"ATRV", "Sick", "props/crates#small_crate"} <= kinds
        # names of exporters, such as v1.node10.visual, are no names for people
        assert [kind for kind in kinds if kind.count(".visual") or kind.endswith("#origin")] == []
        picture = desk._wait("model_picture", kind="ATRV")
        status, headers, data = fetch(simulation.view.url.rstrip("/") + picture["url"])
        assert (status, headers["Content-Type"], data[8:12]) == (200, "image/webp", b"WEBP")


def test_a_model_is_dragged_into_the_world_and_saved(
    desk: Desk, tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    desk._client.socket.close()  # the browser drives
    simulation = desk.simulation
    page = open_page(simulation.view.url, width=1000, height=700)

    def shown(condition: str) -> None:
        wait_until(lambda: (simulation.step(1), page.evaluate(f"Boolean({condition})"))[1], condition)

    shown("morse.stage.world && morse.seat.drives.value && !morse.panels.editor.element.hidden")
    page.get_by_role("button", name="add", exact=True).click()
    shown("document.querySelector('[data-kind=Morsy]')")
    # the list is made again when its pictures arrive
    box = wait_until(page.locator("[data-kind=Morsy]").bounding_box)
    page.mouse.move(box["x"] + 20, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(600, 500, steps=3)
    page.mouse.up()
    shown("morse.components.selected.value === 'morsy'")
    page.get_by_role("button", name="save 1 change").click()
    shown("document.querySelector('dialog.save .added')?.checkVisibility()")
    page.locator("dialog.save").get_by_role("button", name="save", exact=True).click()
    wait_until(lambda: (simulation.step(1), "morsy = Morsy()" in (tmp_path / "scene.py").read_text())[1], "the script")


def test_on_a_telephone_one_model_is_added_after_the_other(desk: Desk, open_page: Callable[..., Page]) -> None:
    desk._client.socket.close()  # the browser drives
    simulation = desk.simulation
    page = open_page(simulation.view.url, width=390, height=780, has_touch=True, is_mobile=True)

    def shown(condition: str) -> None:
        wait_until(lambda: (simulation.step(1), page.evaluate(f"Boolean({condition})"))[1], condition)

    shown("morse.stage.world && morse.seat.drives.value && !morse.panels.editor.element.hidden")
    page.evaluate("morse.shell.show('left')")
    page.get_by_role("button", name="add", exact=True).click()
    for kind, name in (("Morsy", "morsy"), ("IMU", "morsy.imu")):
        shown(f"document.querySelector('[data-kind={kind}]')")
        page.locator(f"[data-kind={kind}]").click()
        shown(f"morse.components.selected.value === '{name}'")
        assert page.locator(".add-panel").is_visible()
    # another simulation on this machine may have the port of the services, and the page says so
    assert [one for one in toasts(page) if "morsy" in one] == ["morsy is in the world.", "morsy.imu is on morsy."]
    # above the list, which covers the world
    layers = "['.toasts', '.left'].map((name) => Number(getComputedStyle(document.querySelector(name)).zIndex))"
    above, below = page.evaluate(layers)
    assert above > below


PARTS = [
    {"kind": "Morsy", "name": "Morsy", "group": "robots", "doc": "An indoor robot with wheels", "words": "wheels"},
    {"kind": "IMU", "name": "IMU", "group": "sensors", "doc": "An inertial measurement unit"},
    {"kind": "Pose", "name": "Pose", "group": "sensors", "doc": "The full pose", "words": "position where"},
    {"kind": "MotionVW", "name": "MotionVW", "group": "actuators", "words": "drive wheels steer"},
    {"kind": "Camera", "name": "Camera", "group": "solids, lamps and cameras"},
    {"kind": "Cone", "name": "Cone", "group": "solids, lamps and cameras"},
    {"kind": "props/crates#small_crate", "name": "small crate", "group": "crates"},
    {"kind": "props/crates#large_crate", "name": "large crate", "group": "crates"},
]


def test_a_robot_is_built_from_nothing_driven_saved_and_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, open_page: Callable[..., Page]
) -> None:
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(PARTS))
    script = tmp_path / "scene.py"
    script.write_text('from morse.builder import *\n\nenv = Environment("empty")\n')
    with morse.load(script, view="web") as simulation:
        page = open_page(simulation.view.url, width=1000, height=700)

        def shown(condition: str) -> None:
            wait_until(lambda: (simulation.step(1), page.evaluate(f"Boolean({condition})"))[1], condition)

        def add(words: str, kind: str, name: str) -> None:
            page.get_by_role("searchbox", name="find a model").fill(words)
            shown(f"document.querySelectorAll('.model').length && document.querySelector('[data-kind=\"{kind}\"]')")
            page.locator(f'[data-kind="{kind}"]').first.press("Enter")
            shown(f"morse.components.selected.value === '{name}'")

        shown("morse.stage.world && morse.seat.drives.value && !morse.panels.editor.element.hidden")
        page.get_by_role("button", name="add", exact=True).click()
        # those of their group that are none are not among them
        page.get_by_role("searchbox", name="find a model").fill("camera")
        shown("document.querySelectorAll('.model').length")
        assert page.locator(".model .caption").all_inner_texts() == ["Camera"]
        page.get_by_role("searchbox", name="find a model").fill("lamps")
        assert page.locator(".model .caption").all_inner_texts() == ["Camera", "Cone"]
        # what drives stands before the robots that have wheels
        page.get_by_role("searchbox", name="find a model").fill("wheels")
        assert page.locator(".model .caption").all_inner_texts() == ["MotionVW", "Morsy"]
        # a part of a word is none
        page.get_by_role("searchbox", name="find a model").fill("door")
        assert page.locator(".models").inner_text() == "Nothing of that name."
        add("morsy", "Morsy", "morsy")
        add("drive", "MotionVW", "morsy.motion_vw")
        add("imu", "IMU", "morsy.imu")
        add("where", "Pose", "morsy.pose")
        for number, name in enumerate(["small_crate", "large_crate", "small_crate_2"]):
            add("crate", f"props/crates#{'large' if number == 1 else 'small'}_crate", name)
            # not into each other
            place = {"node": name, "position": [4, 2.0 * number - 2, 0.5], "quaternion": [1, 0, 0, 0], "first": True}
            page.evaluate("(place) => void morse.connection.request({type: 'teleport', ...place})", place)
        # it is driven by the field of its actuator, and its sensor says so
        page.evaluate("morse.components.selected.set('morsy.motion_vw')")
        speed = page.locator("table.commands").get_by_label("v", exact=True)
        wait_until(lambda: (simulation.step(1), speed.count())[1], "the field of the speed")
        speed.fill("1")
        speed.press("Enter")
        x = simulation.context.components["morsy.pose"].bge_object.worldPosition.x
        wait_until(
            lambda: (
                simulation.step(5),
                simulation.context.components["morsy.pose"].bge_object.worldPosition.x > x + 0.5,
            )[1],
            "it drives",
        )
        page.evaluate("morse.components.selected.set('morsy.pose')")
        shown(f"Number(morse.components.valuesOf('morsy.pose')?.data.x) > {x + 0.5}")
        page.locator("button.save").click()
        shown("document.querySelector('dialog.save .added')?.checkVisibility()")
        page.locator("dialog.save").get_by_role("button", name="save", exact=True).click()
        wait_until(lambda: (simulation.step(1), "MotionVW" in script.read_text())[1], "the script")
        here = {root.name for root in simulation.scene.roots}, set(simulation.context.components)
        with morse.load(script) as again:
            assert ({root.name for root in again.scene.roots}, set(again.context.components)) == here
        assert here[1] == {"morsy.motion_vw", "morsy.imu", "morsy.pose"}
        assert {"small_crate", "large_crate", "small_crate_2"} <= here[0]


def test_the_page_says_in_words_where_the_ground_ends(tmp_path: Path, open_page: Callable[..., Page]) -> None:
    script = tmp_path / "scene.py"
    # the ground of this world is 40 m wide
    script.write_text(SCENE.replace("translate(1.0, 2.0)", "translate(18.0, 2.0)"))
    with morse.load(script, view="web") as simulation:
        page = open_page(simulation.view.url)
        told = page.locator(".world-end")

        def says(text: str) -> None:
            wait_until(lambda: (simulation.step(1), text in (told.text_content() or ""))[1], text)

        wait_until(lambda: (simulation.step(1), page.evaluate("Boolean(morse.stage.world)"))[1], "the world")
        assert told.is_hidden()
        simulation.place("robot", [19.0, 2.0, 0.0])
        says("The ground ends at x = 20 m: beyond it, robot falls.")
        simulation.place("robot", [21.0, 2.0, 0.0])
        says("robot has fallen off: the ground of this world ends at x = 20 m.")


def test_the_page_says_nothing_of_the_end_of_the_ground_behind_a_wall(
    tmp_path: Path, open_page: Callable[..., Page]
) -> None:
    """Robot `inner` is before the parapet at the edge of the passage, `outer` is on it."""
    script = tmp_path / "scene.py"
    places = "".join(
        f"{name} = ATRV()\n{name}.translate({x}, 2.9, {z})\n{name}.properties(NoGravity=True)\n"
        for name, x, z in (("inner", 7.4, 0.3), ("outer", 8.15, 1.2))
    )
    script.write_text(f"from morse.builder import *\n\n{places}Environment('tum_kitchen/tum_kitchen', fastmode=True)\n")
    with morse.load(script, view="web") as simulation:
        told = open_page(simulation.view.url, wait=False).locator(".world-end")
        text = "The ground ends at x = 8.212 m: beyond it, outer falls."
        wait_until(lambda: (simulation.step(1), (told.text_content() or "") == text)[1], text)
