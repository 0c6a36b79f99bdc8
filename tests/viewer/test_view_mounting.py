"""Components are put on a surface that is pointed at: of a robot, an arm or a pan-tilt unit; and moved on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from editor_desk import Desk
from view_pages import Client

import morse
from morse.core.exceptions import MorseError
from morse.viewer.catalog import Catalog
from tests.kit.waiting import wait_until

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Page

    from morse.simulation.simulation import Simulation

SCENE = """from morse.builder import *

robot = ATRV()
robot.translate(1.0, 2.0)
robot.rotate(z=0.5)

arm = KukaLWR()
arm.translate(z=0.9)
robot.append(arm)

ptu = PTU()
ptu.translate(0.3, z=0.9)
robot.append(ptu)

camera = VideoCamera()
camera.translate(0.4, z=0.8)
robot.append(camera)

at_tip = Pose()
arm.append(at_tip)

env = Environment("empty")
env.set_gravity(0)
"""
MODELS = [
    *({"kind": kind, "name": kind, "group": "sensors"} for kind in ("VideoCamera", "Pose", "IMU")),
    *({"kind": kind, "name": kind, "group": "actuators"} for kind in ("MotionVW", "KukaLWR", "PTU", "LedArray")),
]


@pytest.fixture
def script(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(Catalog, "open", lambda catalog: catalog._take(MODELS))
    script = tmp_path / "scene.py"
    script.write_text(SCENE)
    return script


@pytest.fixture
def desk(script: Path) -> Iterator[Desk]:
    with morse.load(script, view="web") as simulation, Client(simulation.view.url) as client:
        simulation.step(1)
        desk = Desk(simulation, client)
        desk.models()
        yield desk


def pose_of(simulation: Simulation, name: str) -> tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]:
    """Position, m, and the axes of an object in the world, as columns."""
    body = simulation.world.objects_by_name[name]
    return np.array(body.worldPosition), np.array(body.worldOrientation)


def same_after_a_load(desk: Desk, script: Path, *names: str) -> None:
    """Save, load, and compare poses in the frames of the robots."""
    desk.do("save_scene", write=True)
    with morse.load(script) as again:
        again.step(1)
        assert set(again.context.components) == set(desk.simulation.context.components)
        for name in names:
            here, there = pose_of(desk.simulation, name), pose_of(again, name)
            assert there[0] == pytest.approx(here[0], abs=2e-3), name
            assert there[1] == pytest.approx(here[1], abs=2e-3), name


@pytest.mark.parametrize(
    ("normal", "x", "z"),
    [
        ([0, 0, 1], [1, 0, 0], [0, 0, 1]),  # on top, it looks ahead
        ([1, 0, 0], [1, 0, 0], [0, 0, 1]),  # at a side, away from it
        ([0, 1, 0], [0, 1, 0], [0, 0, 1]),
        ([-1, 0, 0], [-1, 0, 0], [0, 0, 1]),
        ([0, 0, -1], [1, 0, 0], [0, 0, 1]),  # below, not upside down
        ([math.sin(0.3), 0, math.cos(0.3)], [math.cos(0.3), 0, -math.sin(0.3)], [math.sin(0.3), 0, math.cos(0.3)]),
    ],
)
def test_a_sensor_stands_on_the_surface_that_is_pointed_at(
    desk: Desk, script: Path, normal: list[float], x: list[float], z: list[float]
) -> None:
    origin, axes = pose_of(desk.simulation, "robot")
    point = origin + axes @ [0.1, 0.2, 0.5]
    name = desk.do("add_model", model="IMU", robot="robot", position=point.tolist(), normal=(axes @ normal).tolist())
    assert name == "robot.imu"
    place, turn = pose_of(desk.simulation, name)
    assert axes.T @ turn[:, 0] == pytest.approx(x, abs=1e-3)
    assert axes.T @ turn[:, 2] == pytest.approx(z, abs=1e-3)
    # its lowest point is at the surface: it is as far away as it is large
    away = (place - point) @ (axes @ normal)
    assert -1e-3 <= away < 0.2
    same_after_a_load(desk, script, name)


def test_a_part_of_an_arm_carries_what_is_put_on_it(desk: Desk, script: Path) -> None:
    simulation = desk.simulation
    point, _ = pose_of(simulation, "kuka_4")
    name = desk.do("add_model", model="Pose", robot="kuka_4", position=point.tolist(), normal=[0, 0, 1])
    assert name == "robot.arm.pose"
    here, _ = pose_of(simulation, name)
    assert here == pytest.approx(point, abs=0.15)
    hand = desk.do("add_model", model="VideoCamera", robot="robot.arm")
    assert hand == "robot.arm.video_camera"
    tip, _ = pose_of(simulation, "robot.arm.at_tip")
    assert pose_of(simulation, hand)[0] == pytest.approx(tip, abs=1e-3)
    same_after_a_load(desk, script, name, hand)
    before = pose_of(simulation, name)[0], pose_of(simulation, hand)[0]
    simulation.context.components["robot.arm"].set_rotation("kuka_2", 0.6)
    wait_until(lambda: (simulation.step(1), np.linalg.norm(pose_of(simulation, hand)[0] - before[1]) > 0.3)[1], "bent")
    assert np.linalg.norm(pose_of(simulation, name)[0] - before[0]) > 0.05
    # they measure where they are
    assert simulation.context.components[name].local_data["x"] == pytest.approx(
        pose_of(simulation, name)[0][0], abs=0.02
    )
    for _ in range(2):
        desk.do("undo_change")
    assert "robot.arm.pose" not in simulation.context.components


def test_a_pan_tilt_unit_turns_what_it_carries(desk: Desk, script: Path) -> None:
    simulation = desk.simulation
    name = desk.do("add_model", model="VideoCamera", robot="robot.ptu")
    assert name == "robot.ptu.video_camera"
    same_after_a_load(desk, script, name)
    _, before = pose_of(simulation, name)
    simulation.context.components["robot.ptu"].local_data["pan"] = 0.8
    wait_until(lambda: (simulation.step(1), pose_of(simulation, name)[1][:, 0] @ before[:, 0] < 0.8)[1], "turned")


def test_what_was_added_carries_as_well_and_is_duplicated_and_deleted_with_it(desk: Desk, script: Path) -> None:
    assert desk.do("add_model", model="PTU", robot="robot") == "robot.ptu_2"
    assert desk.do("add_model", model="VideoCamera", robot="robot.ptu_2") == "robot.ptu_2.video_camera"
    desk.do("configure", component="robot.ptu_2", method="frequency", values={"": 30})
    assert "robot.ptu_2.video_camera" in desk.simulation.context.components
    same_after_a_load(desk, script, "robot.ptu_2.video_camera")
    twin = desk.do("duplicate_object", node="robot.ptu_2")
    twins = [one for one in desk.simulation.context.components if one.startswith(f"{twin}.")]
    assert len(twins) == 1
    before = set(desk.simulation.context.components)
    desk.do("delete_object", node="robot.ptu_2")
    assert before - set(desk.simulation.context.components) == {"robot.ptu_2", "robot.ptu_2.video_camera"}
    desk.do("undo_change")
    assert set(desk.simulation.context.components) == before


def test_a_deleted_arm_comes_back_with_what_it_carries(desk: Desk, script: Path) -> None:
    before = set(desk.simulation.context.components)
    desk.do("delete_object", node="robot.arm")
    assert before - set(desk.simulation.context.components) == {"robot.arm", "robot.arm.at_tip"}
    desk.do("undo_change")
    assert set(desk.simulation.context.components) == before
    # it has no settings that would be lost
    answer = desk.ask("configure", component="robot.arm", method="frequency", values={"": 30})
    assert "robot.arm.at_tip" in answer["error"]
    assert set(desk.simulation.context.components) == before


def test_a_camera_that_is_put_on_a_side_looks_away_from_it(desk: Desk, script: Path) -> None:
    simulation = desk.simulation
    origin, axes = pose_of(simulation, "robot")
    point = (origin + axes @ [0.0, 0.4, 0.3]).tolist()
    name = desk.do("add_model", model="VideoCamera", robot="robot", position=point, normal=axes[:, 1].tolist())
    # the Z axis of a camera is its line of sight, its Y axis is down
    _, turn = pose_of(simulation, name)
    assert turn[:, 2] == pytest.approx(axes[:, 1], abs=1e-3)
    assert turn[:, 1] == pytest.approx(-axes[:, 2], abs=1e-3)
    same_after_a_load(desk, script, name)


@pytest.mark.parametrize("name", ["robot.camera", "robot.arm.at_tip", "robot.imu"])
def test_a_component_is_moved_saved_and_restarted(desk: Desk, script: Path, name: str) -> None:
    simulation = desk.simulation
    desk.do("add_model", model="IMU", robot="robot")
    first, _ = pose_of(simulation, name)
    place = first + np.array([0.1, 0.05, 0.2])
    c, s = math.cos(0.25), math.sin(0.25)
    desk.do("teleport", node=name, position=place.tolist(), quaternion=[c, 0, 0, s], first=True)
    assert pose_of(simulation, name)[0] == pytest.approx(place, abs=1e-3)
    assert pose_of(simulation, name)[1][:, 0] == pytest.approx([math.cos(0.5), math.sin(0.5), 0], abs=1e-3)
    same_after_a_load(desk, script, name)
    simulation.restart()
    wait_until(lambda: (simulation.step(1), abs(pose_of(simulation, name)[0] - place).max() < 2e-3)[1], "again")
    # settings create it anew, where it is
    desk.do("configure", component=name, method="frequency", values={"": 10})
    assert pose_of(simulation, name)[0] == pytest.approx(place, abs=2e-3)
    desk.do("undo_change")
    desk.do("undo_change")
    assert pose_of(simulation, name)[0] == pytest.approx(first, abs=2e-3)
    desk.do("redo_change")
    assert pose_of(simulation, name)[0] == pytest.approx(place, abs=2e-3)


@pytest.mark.parametrize(
    ("fields", "why"),
    [
        ({"robot": ""}, "on a robot"),
        ({"robot": "Ground"}, "on a robot"),
        ({"robot": "nobody"}, "on a robot"),
        ({"robot": "robot", "position": [0, 0, 0], "normal": [0, 0, 0]}, "no surface"),
        ({"robot": "robot", "position": [0, 0, 0], "normal": [1e-320, 0, 0]}, "no surface"),
    ],
)
def test_what_carries_nothing_is_refused(desk: Desk, fields: dict[str, Any], why: str) -> None:
    before = set(desk.simulation.context.components)
    answer = desk.ask("add_model", model="IMU", **fields)
    assert not answer["ok"]
    assert why in answer["error"]
    assert set(desk.simulation.context.components) == before


def test_clients_name_the_part_that_carries(desk: Desk) -> None:
    simulation = desk.simulation
    simulation.spawn("robot.arm.one", "Pose\nappend(child='kuka_4')", by_client=True)
    assert pose_of(simulation, "robot.arm.one")[0] == pytest.approx(pose_of(simulation, "kuka_4")[0], abs=1e-3)
    state = simulation.save()
    simulation.delete("robot.arm.one")
    simulation.restore(state)
    assert pose_of(simulation, "robot.arm.one")[0] == pytest.approx(pose_of(simulation, "kuka_4")[0], abs=1e-3)
    for kind, why in [
        ("Pose\nappend(child='kuka_99x')", "no part 'kuka_99x'"),
        ("Pose\nappend('kuka_4')", "append"),
        ("Pose\nappend(child=4)", "append"),
        ("Pose\nappend(child='kuka_4')\nappend(child='kuka_5')", "one part"),
    ]:
        digest = simulation.state_hash()
        with pytest.raises(MorseError, match=why):
            simulation.spawn("robot.arm.two", kind, by_client=True)
        assert simulation.state_hash() == digest


def test_a_sensor_is_dropped_on_a_robot_and_moved_by_its_handles(script: Path, open_page: Callable[..., Page]) -> None:
    with morse.load(script, view="web") as simulation:
        page = open_page(simulation.view.url, width=1000, height=700)

        def shown(condition: str) -> None:
            wait_until(lambda: (simulation.step(1), page.evaluate(f"Boolean({condition})"))[1], condition)

        shown("morse.stage.world && morse.seat.drives.value && !morse.panels.editor.element.hidden")
        page.evaluate("""(() => {
            const robot = morse.stage.world.find("robot");
            morse.panels.viewMenu.look("corner");
        })()""")
        page.get_by_role("button", name="add", exact=True).click()
        shown("document.querySelector('[data-kind=IMU]')")
        # the point of the page at which the bonnet of the robot is
        at = page.evaluate("""(() => {
            const { stage } = morse;
            stage.draw();
            const point = stage.world.find("robot").frame.localToWorld(stage.view.position.clone().set(0.2, 0.25, 0.3));
            const { x, y } = point.project(stage.view.camera);
            const box = stage.renderer.domElement.getBoundingClientRect();
            return [box.left + ((x + 1) / 2) * box.width, box.top + ((1 - y) / 2) * box.height];
        })()""")
        box = wait_until(page.locator("[data-kind=IMU]").bounding_box)
        page.mouse.move(box["x"] + 20, box["y"] + 20)
        page.mouse.down()
        page.mouse.move(*at, steps=3)
        page.mouse.up()
        shown("morse.components.selected.value === 'robot.imu'")
        robot, axes = pose_of(simulation, "robot")
        local = axes.T @ (pose_of(simulation, "robot.imu")[0] - robot)
        # where it was dropped, on the line of sight, and not in the middle
        assert abs(local[0]) < 0.8
        assert 0.0 < local[2] < 1.0
        page.keyboard.press("m")
        shown("morse.panels.mover.node.value?.name === 'robot.imu'")
        before = pose_of(simulation, "robot.imu")[0]
        page.evaluate("""(() => {
            const { mover } = morse.panels;
            morse.stage.draw();
            mover.begin();
            mover.proxy.position.z += 0.5;
            mover.put(true);
        })()""")
        shown("morse.panels.mover.node.value?.name === 'robot.imu'")
        wait_until(
            lambda: (simulation.step(1), abs(pose_of(simulation, "robot.imu")[0][2] - before[2] - 0.5) < 0.01)[1],
            "it is higher",
        )
        # the handles stay, and show where it is
        shown(
            f"Math.abs(morse.stage.world.find('robot.imu').frame.matrixWorld.elements[14] - {before[2] + 0.5}) < 0.02"
        )
        assert page.evaluate("morse.panels.mover.node.value.name") == "robot.imu"
        # the view from on board is that of what is selected: of a camera its own
        page.keyboard.press("Escape")
        for name, ahead, up in (("robot.camera", 2, -1), ("robot.imu", 0, 2)):
            page.evaluate(f"morse.components.selected.set('{name}')")
            page.keyboard.press("2")
            place, turn = pose_of(simulation, name)
            x, y, z = turn[:, ahead]
            shown(f"morse.follow.mode.value === 'first' && morse.follow.node.name === '{name}'")
            shown(f"morse.stage.view.ahead.distanceTo({{x: {x}, y: {y}, z: {z}}}) < 0.01")
            x, y, z = place + 0.12 * turn[:, ahead]
            shown(f"morse.stage.view.position.distanceTo({{x: {x}, y: {y}, z: {z}}}) < 0.01")
            above = -turn[:, 1] if up < 0 else turn[:, up]
            assert np.dot(page.evaluate("morse.stage.view.above.toArray()"), above) > 0.99


def test_who_only_watches_sees_what_is_locked_and_why(script: Path, open_page: Callable[..., Page]) -> None:
    with morse.load(script, view="web") as simulation:
        drives = open_page(simulation.view.url, wait=False, width=1100, height=700)

        def shown(page: Page, condition: str) -> None:
            wait_until(lambda: (simulation.step(1), page.evaluate(f"Boolean({condition})"))[1], condition)

        shown(drives, "window.morse?.stage.world && morse.seat.drives.value")
        watches = open_page(simulation.view.url, wait=False, width=1100, height=700)
        shown(watches, "window.morse?.stage.world && !morse.panels.editor.element.hidden")
        places = ".inspector :is(.properties, .commands, .switch) :is(input, select), .editor .tools button"
        locked = f"[...document.querySelectorAll('{places}')]"
        locked += ".filter((one) => one.checkVisibility() && one.ariaLabel !== 'Script')"
        for name in ("robot.camera", "robot.ptu"):
            for page in (drives, watches):
                page.evaluate(f"morse.components.selected.set('{name}')")
                shown(page, f"{locked}.length > 4")
            wait_until(
                lambda: (simulation.step(1), watches.evaluate(f"{locked}.every((one) => one.disabled)"))[1], name
            )
            assert watches.evaluate(f"{locked}.every((one) => /only the page that drives/i.test(one.title))")
            assert not drives.evaluate(
                "[...document.querySelectorAll('.properties input')].some((one) => one.disabled)"
            )
