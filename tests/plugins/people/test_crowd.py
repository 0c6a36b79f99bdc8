"""A crowd in a scene: seen by sensors, obedient to services, with the same bits in every form of a run."""

import math

import numpy as np
import pytest

import morse

SCENE = """
from morse.builder import *

crowd = Crowd("people", 12, model={model!r}, groups=0.4, children=0.2, wheelchairs=0.1)
crowd.start([(0, -3), (6, 3)])
crowd.goals([(14, 0), (0, 0)], then="repeat")
robot = ATRV("robot")
robot.translate(9, 0.3, 0.2)
motion = MotionVW("motion")
robot.append(motion)
scan = Hokuyo("scan")
scan.translate(z=0.3)
robot.append(scan)
crowd.avoids(robot, attention=0.8)
wall = Cube("wall")
wall.scale = (0.2, 2, 1)
wall.translate(4, 4, 1)
wall.static()
env = Environment("empty")
"""
MODELS = ("social-force", "orca")


@pytest.fixture(params=MODELS)
def scene(request, tmp_path):
    path = tmp_path / "scene.py"
    path.write_text(SCENE.format(model=request.param), "utf-8")
    return path


def test_people_walk_at_their_speeds_and_never_through_each_other(scene):
    with morse.load(scene) as sim:
        begin = sim.people.data["positions"]
        assert begin.shape == (12, 3)
        assert sim.people.data["present"].all()
        assert (begin[:, 0] >= 0.0).all()
        assert (begin[:, 0] <= 6.0).all()
        for _ in range(20):
            sim.step(15)
            data = sim.people.data
            here = data["positions"][:, :2]
            apart = np.linalg.norm(here[:, None] - here[None], axis=2) + 9.0 * np.eye(12)
            assert apart.min() > 0.3
            assert np.linalg.norm(data["velocities"], axis=1).max() < 1.3 * (1.34 + 2 * 0.26) + 1e-6
        assert (sim.people.data["positions"][:, 0] > begin[:, 0] + 2.0).sum() >= 9


def test_a_seed_is_a_crowd(scene):
    runs = []
    for seed in (3, 3, 4):
        with morse.load(scene, seed=seed) as sim:
            sim.step(60)
            runs.append((sim.people.data["positions"], sim.state_hash()))
    assert np.array_equal(runs[0][0], runs[1][0])
    assert runs[0][1] == runs[1][1]
    assert not np.array_equal(runs[0][0], runs[2][0])


def test_a_restored_state_and_a_restart_go_on_with_the_same_bits(scene):
    with morse.load(scene) as sim:
        sim.step(40)
        sim.people.stop(3).result()
        sim.people.send(4, 10.0, 2.0).result()
        state = sim.save()
        sim.step(80)
        there, digest = sim.people.data["positions"], sim.state_hash()
        sim.restore(state)
        assert not np.array_equal(sim.people.data["positions"], there)
        sim.step(80)
        assert np.array_equal(sim.people.data["positions"], there)
        assert sim.state_hash() == digest
        ranges = np.array(sim.robot.scan.get()["range_list"])
    with morse.load(scene) as sim:
        sim.restore(state)
        sim.step(80)
        assert sim.state_hash() == digest
        assert np.array_equal(np.array(sim.robot.scan.get()["range_list"]), ranges)


def test_rows_of_a_batch_have_the_bits_of_single_runs(scene):
    with morse.batch(scene, 3, seed=5) as batch:
        batch.step(50)
        rows = [batch[k].people.data["positions"] for k in range(3)]
        seeds = batch.seeds
    for seed, row in zip(seeds, rows, strict=True):
        with morse.load(scene, seed=seed) as sim:
            sim.step(50)
            assert np.array_equal(sim.people.data["positions"], row)


def test_a_lidar_sees_legs(tmp_path):
    """Two cylinders of 7 cm at the height of the laser, 18 cm apart, that stand: their widths and distances."""
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
crowd = Crowd("people", 1, deviation=0.0)
crowd.start(places=[(3, 0)])
robot = FakeRobot("robot")
scan = Hokuyo("scan")
scan.translate(z=0.3)
robot.append(scan)
Environment("empty")
""",
        "utf-8",
    )
    with morse.load(path) as sim:
        data = sim.robot.scan.get()
        here = sim.people.data["positions"][0]
        height = sim.people.ask(0).result()["height"]
        ranges = np.array(data["range_list"])
        points = np.array(data["point_list"])[ranges < 29.0]
    assert ranges.min() == pytest.approx(here[0] - 0.07 * height / 1.72, abs=0.01)
    radius = 0.07 * height / 1.72
    for side in (-1.0, 1.0):
        leg = points[np.sign(points[:, 1]) == side]
        centre = [here[0], side * 0.09 * height / 1.72]
        assert len(leg) > 5
        assert np.linalg.norm(leg[:, :2] - centre, axis=1) == pytest.approx(radius, abs=2e-3)


def test_a_foot_that_supports_does_not_slide(scene):
    """The sole of a leg on the ground stays within a millimetre while the other one swings."""
    with morse.load(scene) as sim:
        crowd = sim.people.component
        total, on_ground = 0, 0
        before = None
        for _ in range(90):
            sim.step()
            gait = crowd.gait
            supporting = np.floor(gait.phase).astype(int) % 2
            names = [f"people {k} {side} leg" for k in range(12) for side in ("left", "right")]
            world = sim.context.world.objects_by_name
            soles = {name: np.array(world[name].world_pose()[0]) for name in names if name in world}
            walking = np.linalg.norm(sim.people.data["velocities"], axis=1) > 0.4
            now = {
                k: (
                    supporting[k],
                    math.floor(gait.phase[k]),
                    soles[f"people {k} {('left', 'right')[supporting[k]]} leg"],
                )
                for k in range(12)
                if walking[k] and not gait.rides[k]
            }
            for k, (side, step, sole) in now.items():
                total += 1
                on_ground += abs(sole[2]) < 0.03
                if before and k in before and before[k][:2] == (side, step):
                    assert np.linalg.norm(sole[:2] - before[k][2][:2]) < 0.02
            before = now
        assert total > 300
        assert on_ground == total


def test_the_same_people_are_in_images_and_segmentations(tmp_path):
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
crowd = Crowd("people", 1, deviation=0.0)
crowd.start(places=[(3, 0)])
robot = FakeRobot("robot")
camera = SegmentationCamera("camera")
camera.translate(z=1.0)
camera.properties(cam_width=64, cam_height=64)
robot.append(camera)
Environment("empty")
""",
        "utf-8",
    )
    with morse.load(path) as sim:
        data = sim.robot.camera.get()
        number = next(one["id"] for one in data["labels"] if one["name"] == "people 0")
        assert next(one["class"] for one in data["labels"] if one["id"] == number) == "person"
        seen = next(one for one in data["objects"] if one["name"] == "people 0")
        assert seen["pixels"] == (np.array(data["image"]) == number).sum() > 100
        assert seen["size"][2] == pytest.approx(sim.people.ask(0).result()["height"], rel=0.05)


def test_services_call_stop_send_resume_and_ask(scene):
    with morse.load(scene) as sim:
        sim.step(10)
        assert sim.people.ask(0).result()["state"] == "walks"
        sim.people.stop().result()
        sim.step(90)
        assert np.linalg.norm(sim.people.data["velocities"], axis=1).max() < 0.3
        called = sim.people.call(10.0, -4.0, 2).result()
        assert len(set(called)) == 2
        sim.people.send(5, 3.0, -3.0).result()
        for _ in range(60):
            sim.step(20)
            states = [sim.people.ask(k).result()["state"] for k in (*called, 5)]
            if states == ["stopped"] * 3:
                break
        assert states == ["stopped"] * 3
        for person in called:
            assert np.linalg.norm(sim.people.data["positions"][person, :2] - (10.0, -4.0)) < 1.5
        sim.people.resume().result()
        sim.step(60)
        assert np.linalg.norm(sim.people.data["velocities"], axis=1).max() > 0.5


def test_people_leave_and_others_enter(tmp_path):
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
crowd = Crowd("people", 6)
crowd.start([(0, 0), (3, 3)], over=4.0)
crowd.goals([[(6, 0), (7, 0), (7, 3), (6, 3)]], then="leave")
robot = FakeRobot("robot")
robot.translate(-3, 1.5)
scan = Hokuyo("scan")
scan.translate(z=0.3)
robot.append(scan)
Environment("empty")
""",
        "utf-8",
    )
    with morse.load(path) as sim:
        counts = []
        for _ in range(15):
            sim.step(60)
            counts.append(int(sim.people.data["present"].sum()))
        assert max(counts) >= 3
        assert counts[-1] == 0
        assert sim.people.ask(0).result()["state"] == "gone"
        assert min(sim.robot.scan.get()["range_list"]) > 29.0


def test_a_robot_and_a_person_push_each_other_and_the_contact_is_reported(tmp_path, caplog):
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
crowd = Crowd("people", 1, deviation=0.0)
crowd.start(places=[(2.0, 0.0)])
robot = ATRV("robot")
robot.translate(0, 0, 0.1)
motion = MotionVW("motion")
robot.append(motion)
crowd.avoids(robot, attention=0.0)
Environment("empty")
""",
        "utf-8",
    )
    with morse.load(path) as sim:
        sim.robot.motion.publish({"v": 1.0, "w": 0.0})
        found = []
        for _ in range(150):
            sim.step()
            found += sim.people.data["contacts"]
        assert found
        first = found[0]
        assert (first["person"], first["robot"]) == (0, "robot")
        assert first["force"] > 0.0
        assert first["limit"] in (260.0, 220.0, 440.0, 360.0, 280.0)
        assert first["point"][0] < 2.0
        assert sim.people.data["positions"][0, 0] > 2.2
        assert sim.people.data["exceeded"] >= 1
        assert "robot and person 0 of people touch" in caplog.text
        # the person is not inside of the robot
        here = sim.context.world.objects_by_name["robot"].world_pose()[0]
        assert sim.people.data["positions"][0, 0] - here[0] > 0.4


def test_a_touch_of_the_head_is_no_impact_and_an_impact_on_it_is_not_permitted(tmp_path, caplog):
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
crowd = Crowd("people", 1)
crowd.start(places=[(2.0, 0.0)])
Environment("empty")
""",
        "utf-8",
    )
    contact = {"person": 0, "robot": "arm", "region": "face", "limit": 0.0}
    with morse.load(path) as sim:
        crowd = sim.context.robots["people"]
        for force, exceeded in ((0.3, 0), (40.0, 1)):
            crowd._around.touch = lambda *_, force=force: [{**contact, "force": force}]
            sim.step()
            assert sim.people.data["exceeded"] == exceeded
    assert "with 0 N" not in caplog.text
    assert "arm and person 0 of people touch with 40 N, face: ISO/TS 15066 permits no impact there" in caplog.text


def test_a_tracker_tells_who_is_near_and_not_who_is_behind_a_wall(tmp_path):
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
crowd = Crowd("people", 3)
crowd.start(places=[(2.0, 0.0), (0.0, 4.0), (30.0, 0.0)])
wall = Cube("wall")
wall.scale = (2, 0.1, 1.5)
wall.translate(0, 2, 1.5)
wall.static()
robot = FakeRobot("robot")
for name, hidden in (("all", False), ("seen", True)):
    tracker = PeopleTracker(name)
    tracker.properties(Range=10.0, Occlusion=hidden)
    tracker.translate(z=1.0)
    robot.append(tracker)
Environment("empty")
""",
        "utf-8",
    )
    with morse.load(path) as sim:
        found = sim.robot.all.get()["people"]
        assert [one["name"] for one in found] == ["people 0", "people 1"]
        assert found[1]["position"] == pytest.approx([0.0, 4.0, 0.0], abs=0.01)
        assert {"id", "group_id", "velocity", "yaw", "radius", "state"} <= found[0].keys()
        assert [one["name"] for one in sim.robot.seen.get()["people"]] == ["people 0"]


def test_two_crowds_give_way_to_each_other(tmp_path):
    path = tmp_path / "scene.py"
    path.write_text(
        """
from morse.builder import *
for name, x in (("left", -4.0), ("right", 4.0)):
    crowd = Crowd(name, 1, deviation=0.0)
    crowd.start(places=[(x, 0.0)])
    crowd.goals([(-x, 0.0)])
Environment("empty")
""",
        "utf-8",
    )
    with morse.load(path) as sim:
        closest = 9.0
        for _ in range(480):
            sim.step()
            apart = sim.left.data["positions"][0] - sim.right.data["positions"][0]
            closest = min(closest, float(np.linalg.norm(apart)))
        assert closest > 0.35
        assert sim.left.data["positions"][0, 0] > 3.0
        assert sim.right.data["positions"][0, 0] < -3.0


def test_a_crowd_goes_on_when_objects_come_and_go(scene):
    with morse.load(scene) as sim:
        sim.step(30)
        sim.delete("robot")
        sim.step(30)
        world = sim.context.world
        world.remove([world.objects_by_name["wall"]])
        before = sim.people.data["positions"]
        sim.step(60)
        assert sim.failures == ()
        assert np.abs(sim.people.data["positions"] - before).max() > 0.5


def test_a_crowd_comes_to_a_running_simulation(tmp_path):
    from morse.builder import Crowd

    def visitors():
        crowd = Crowd(count=3)
        crowd.start([(-2.0, -2.0), (2.0, 2.0)])
        crowd.goals([(6.0, 0.0)])
        return crowd

    script = tmp_path / "scene.py"
    script.write_text("from morse.builder import *\n\nEnvironment('empty', fastmode=True)\n")
    with morse.load(script) as simulation:
        for name in ("first", "second"):
            simulation.spawn(name, visitors)
        begin = np.array(simulation.context.robots["second"].local_data["positions"])
        simulation.step(120)
        names = [node.name for node in simulation.scene.nodes()]
        assert len(names) == len(set(names))
        assert {"first.person 0", "second.person 2"} <= set(names)
        end = np.array(simulation.context.robots["second"].local_data["positions"])
        assert end.shape == begin.shape
        assert np.linalg.norm(end - begin, axis=1).max() > 0.5
        simulation.delete("first")
        simulation.step(1)
        assert not any(node.name.startswith("first") for node in simulation.scene.nodes())


def test_a_crowd_without_a_plan_walks_to_and_fro_where_it_stands(tmp_path):
    """Also with a wall at one side of its square, 7.75 m wide for 20 people."""
    path = tmp_path / "scene.py"
    wall = "wall = Cube('wall')\nwall.scale = (0.5, 12, 3)\nwall.translate({x}, -3, 1.5)\nwall.static()\n"
    for x in (30.0, 13.5):
        path.write_text(
            "from morse.builder import *\n\npeople = Crowd()\npeople.translate(10, -3)\n"
            f"{wall.format(x=x)}env = Environment('empty')\n"
        )
        with morse.load(path) as sim:
            begin = sim.people.data["positions"][:, :2]
            half = math.sqrt(3.0 * 20) / 2
            assert (np.abs(begin - (10.0, -3.0)) <= half).all()
            assert sim.people.data["present"].all()
            sim.step(240)
            end = sim.people.data["positions"][:, :2]
            assert (np.abs(end - (10.0, -3.0)) <= half + 1.0).all()
            assert (np.linalg.norm(end - begin, axis=1) > 0.5).sum() >= 14
            assert end[:, 0].max() < x
