"""Arrays, rows and errors of a batch."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_scenes import arena, block, body, crowded_arena

import morse
from morse.core.validation.spec import CommandError
from morse.kernel.loading import library
from tests.kit.effort import examples


@pytest.fixture
def many():
    with morse.batch(arena, 3, seed=7) as batch:
        yield batch


def test_shapes_and_types_come_from_the_data(many):
    assert many.command("robot.motion", "v", "w").shape == (3, 2)
    assert many.command("robot.motion", "v").shape == (3,)
    assert many.read("robot.laser", "range_list").shape == (3, 181)
    assert many.read("robot.pose", "x", "y", "yaw").shape == (3, 3)
    assert many.seeds == [7, 8, 9]
    assert len(many) == 3
    assert "3 x arena" in repr(many)


def test_images_depths_and_ids():
    with morse.batch(crowded_arena, 2) as many:
        image, depth = many.read("robot.camera", "image"), many.read("robot.depth", "image")
        bumper = many.read("robot.bumper", "objects")
        many.step(1, measure=True)
        assert (image.shape, image.dtype) == ((2, 12, 16, 3), np.uint8)
        assert (depth.shape, depth.dtype) == ((2, 12, 16), np.float32)
        assert image.any()
        assert bumper.dtype == object


def test_the_arrays_are_the_same_objects_and_read_only(many):
    pose = many.read("robot.pose", "x")
    drive = many.command("robot.motion", "v", "w")
    drive[:, 0] = [1.0, 2.0, 0.0]
    many.step(60)
    assert pose == pytest.approx([1.0, 1.7, 0.0], abs=0.1)  # the wall stands in the way of the second
    with pytest.raises(ValueError, match="read-only"):
        pose[0] = 0.0


def test_measured_at_the_end_of_the_step(many):
    age = many.read("robot.laser", "timestamp")
    many.step(6)
    assert (age < 6 / 60 - 0.05).all()
    many.step(6, measure=True)
    assert age.tolist() == [12 / 60] * 3
    many.step(3, measure=["robot.pose"])
    assert (age < 15 / 60 - 1e-9).all()


def test_in_place_operations_are_commands(many):
    drive, pose = many.command("robot.motion", "v", "w"), many.read("robot.pose", "x")
    drive += 0.0
    drive[1:] += [0.5, 0.0]
    np.add(drive[2], [0.5, 0.0], out=np.asarray(drive)[2])
    many.step(60)
    assert pose == pytest.approx([0.0, 0.5, 1.0], abs=0.05)


def test_a_restarted_row_has_no_command(many):
    drive, pose = many.command("robot.motion", "v", "w"), many.read("robot.pose", "x")
    drive[:] = [1.0, 0.0]
    many.step(30)
    many.restart([1], [42])
    assert many.seeds == [7, 42, 9]
    many.step(30)
    assert pose == pytest.approx([1.0, 0.0, 1.0], abs=0.05)


@pytest.mark.parametrize(
    ("poses", "heading"),
    [([0.5, -0.5, 1.0], 1.0), ([0.5, -0.5, 0.0, 0.0, 0.0, 1.0], 1.0), ([0.5, -0.5, 0.0, 0.0, 0.0, 0.0, 1.0], np.pi)],
)
def test_place_and_measure(many, poses, heading):
    pose, scan = many.read("robot.pose", "x", "y", "yaw"), many.read("robot.laser", "range_list")
    many.step(6, measure=True)
    before = scan.copy()
    many.place([0, 2], "robot", poses)
    many.measure([0, 2])
    assert abs(pose[[0, 2]] - [0.5, -0.5, heading]).max() < 1e-6
    assert (scan[1] == before[1]).all()
    assert (scan[0] != before[0]).any()
    assert (scan[0] == scan[2]).all()


def test_rows_are_numbers_slices_or_masks(many):
    hashes = [sim.state_hash() for sim in many]
    many.step(3)
    for rows in (0, [0], slice(0, 1), np.array([True, False, False]), -3):
        many.restart(rows)
        assert many[0].state_hash() == hashes[0]
        assert many[1].ticks == 3
        many[0].step(1)


@pytest.mark.parametrize(
    ("mistake", "message"),
    [
        (lambda many: many.read("robot.lazer", "range_list"), "no 'lazer'.*'laser'"),
        (lambda many: many.read("robot.laser", "ranges"), "no field 'ranges'"),
        (lambda many: many.read("robbot.laser", "range_list"), "no robot 'robbot'.*'robot'"),
        (lambda many: many.command("robot.laser", "range_list"), "is a sensor: use read"),
        (lambda many: many.restart(3), "no row 3: the batch has 3 rows"),
        (lambda many: many.restart([0, 1], [4]), "2 rows, but 1 seeds"),
        (lambda many: many.restart([True, False]), "a mask"),
        (lambda many: many.restart("all"), "rows are a number"),
        (lambda many: many.place(0, "Wal0", [0, 0, 0]), "no object 'Wal0'.*'Wall"),
        (lambda many: many.place(0, "robot", [0, 0]), "expected finite numbers: x, y, yaw"),
        (lambda many: many.place(0, "robot", [np.nan, 0, 0]), "expected finite numbers"),
        (lambda many: many.place([0, 1], "robot", [[0, 0, 0]] * 3), "one for each of 2 rows"),
        (lambda many: many.step(measure=["robot.lazer"]), "no component 'robot.lazer'"),
        (lambda many: many.step(-1), "does not go backwards"),
        (lambda many: many.step(1.5), "ticks is an integer, not 1.5"),
        (lambda many: many.step(measure=["robot.motion"]), "is an actuator"),
        (lambda many: many.step(measure=7), "a list of full names, not 7"),
        (lambda many: many.measure(sensors=["robot.lazer"]), "no component 'robot.lazer'"),
        (lambda many: many.read(7, "x"), "by its full name"),
        (lambda many: many.command("robot", "x"), "is a robot"),
        (lambda many: many.command("robot.motion", "v", "v"), "given twice"),
        (lambda many: many.contacts("Wal0"), "no object 'Wal0'"),
        (lambda many: many.restart([0, 0]), "given twice"),
        (lambda many: many.restart([[0], [0, 1]]), "rows are a number"),
        (lambda many: many.place(0, "robot", "abc"), "not an array of numbers"),
        (lambda many: many.place(0, "robot", [1e9, 0, 0]), "within 1e"),
        (lambda many: many.vary("robot"), "mass, friction"),
        (lambda many: many.vary("robot", mass="heavy"), "not an array of numbers"),
        (lambda many: many.vary("robot", mass=10**400), "not an array of numbers"),
        (lambda many: many.restore(0, 5), "a state is what save"),
        (lambda many: many.restore(None, [many.save(0)[0], 5, 5]), "a state is what save"),
        (lambda many: many[3], "no row 3"),
        (lambda many: many["robot"], "a row is an integer"),
        (lambda many: morse.batch(arena, 2, sed=3), "no argument 'sed'.*'seed'"),
        (lambda many: morse.batch(arena, 2, record="a.mcap"), "no argument 'record'"),
    ],
)
def test_mistakes_are_named(many, mistake, message):
    hashes = [sim.state_hash() for sim in many]
    with pytest.raises((KeyError, IndexError, TypeError, ValueError), match=message) as caught:
        mistake(many)
    assert not getattr(caught.value, "__notes__", ())
    assert [sim.state_hash() for sim in many] == hashes


@pytest.mark.parametrize(
    "mistake",
    [
        lambda many: many.place(None, "robot", [[1, 0, 0], [1, 0, 0], [np.nan, 0, 0]]),
        lambda many: many.vary("robot", mass=[5, 6, -1]),
        lambda many: many.vary("robot", mass=5, friction=[1, 1, np.nan]),
    ],
)
def test_a_mistake_in_one_row_changes_none(many, mistake):
    hashes = [sim.state_hash() for sim in many]
    with pytest.raises(ValueError, match="robot"):
        mistake(many)
    assert [sim.state_hash() for sim in many] == hashes


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e9])
def test_a_refused_command_stops_no_row_halfway(many, value):
    drive = many.command("robot.motion", "v", "w")
    drive[:] = 0.0
    drive[2, 1] = value
    with pytest.raises(CommandError, match=r"row 2: robot.motion: 'w' is .*expected a "):
        many.step(6)
    assert [sim.ticks for sim in many] == [0, 0, 0]


def test_fields_of_varying_length_are_named():
    def scene():
        from morse.builder import ATRV, DepthCamera, Environment

        robot = ATRV("robot")
        camera = DepthCamera("camera")
        camera.properties(cam_width=8, cam_height=8)
        robot.append(camera)
        Environment("indoors-1/indoor-1")

    with morse.batch(scene, 2) as many:
        many.read("robot.camera", "points")
        many.place(1, "robot", [1.0, 1.0, 2.0])
        with pytest.raises(ValueError, match=r"row 1: points of robot.camera.*keep_resolution=True"):
            many.step(60, measure=True)


def test_an_error_names_its_row_and_the_others_go_on(many):
    def fail():
        raise ZeroDivisionError("on purpose")

    with morse.batch(arena, 3, on_failure="raise") as strict:
        strict[1].before_physics.append(fail)
        with pytest.raises(ZeroDivisionError) as caught:
            strict.step(6)
        assert any("in row 1 of the batch" in note for note in caught.value.__notes__)
        assert [sim.ticks for sim in strict][::2] == [6, 6]


def test_the_number_of_rows_is_required():
    with pytest.raises(ValueError, match="needs the number of rows"):
        morse.batch(arena)
    with pytest.raises(ValueError, match="at least one row"):
        morse.batch(arena, 0)
    with pytest.raises(FileNotFoundError, match=r"nowhere\.py"):
        morse.batch("nowhere.py", 2)


def test_a_closed_batch_says_so(many):
    states = many.save()
    many.close()
    uses = [
        many.step, many.restart, many.save, many.measure, lambda: many.read("robot.pose", "x"), lambda: many[0],
        lambda: many.command("robot.motion"), lambda: many.contacts("robot"), lambda: many.restore(None, states),
        lambda: many.place(None, "robot", [0, 0, 0]), lambda: many.vary("robot", mass=1),
        lambda: many.declarations("robot.pose"),
    ]  # fmt: skip
    for use in uses:
        with pytest.raises(RuntimeError, match="closed"):
            use()


def test_arguments_of_a_script_for_each_row(tmp_path):
    script = tmp_path / "scene.py"
    script.write_text(
        "import sys\nfrom morse.builder import *\nrobot = ATRV()\nrobot.translate(float(sys.argv[1]))\n"
        "robot.append(Pose('pose'))\nenv = Environment('empty')\n"
    )
    with morse.batch(script, arguments=[["1"], ["2"], ["3"]]) as many:
        x = many.read("robot.pose", "x")
        many.step(1)
        assert x == pytest.approx([1.0, 2.0, 3.0], abs=1e-3)


def test_velocities_between_two_periods():
    def scene():
        from morse.builder import Environment, MotionVW, Odometry, Robot

        robot = Robot(name="robot")
        body(robot)
        odometry = Odometry("odometry")
        odometry.frequency(10)
        for part in (MotionVW("motion"), odometry):
            robot.append(part)
        Environment("empty")

    with morse.load(scene) as sim:
        sim.robot.motion.publish({"v": 1.0})
        sim.step(60)
        for ticks in (4, 5, 7, 1):
            sim.step(ticks, measure=True)
            assert sim.robot.odometry.data["vx"] == pytest.approx(1.0, abs=1e-6)


# -- contacts as booleans, impulses and events -----------------------------------------------------

SPEED, MASS = 3.0, 2.0


def free_ball():
    """A ball without a motor, 1 m above the floor and 1 m from a wall, without gravity for it."""
    from morse.builder import Environment, ForceTorque, Pose, Robot, Sphere

    robot = Robot(name="ball")
    shape = Sphere("shape")
    shape.scale = (0.1, 0.1, 0.1)
    game = shape._bpy_object.game
    game.physics_type, game.collision_bounds_type, game.use_collision_bounds = "RIGID_BODY", "SPHERE", True
    robot.append(shape)
    robot.set_rigid_body()
    robot.set_mass(MASS)
    robot.translate(0.0, 0.0, 1.0)
    robot.append(ForceTorque("push"))
    robot.append(Pose("pose"))
    wall = block("Wall", 1.0, 0.0, 0.1, 2.0)
    wall.scale = (0.1, 2.0, 3.0)
    Environment("empty")


def test_the_impulse_is_the_change_of_momentum():
    with morse.load(free_ball) as sim:
        ball = sim.ball.component.bge_object
        contacts = sim.ball.contacts()
        ball.set_velocity([SPEED, 0.0, 0.0], [0.0, 0.0, 0.0])
        begin, before, total = sim.time(), np.array(ball.velocity()[0]), 0.0
        while sim.ticks < 30:
            sim.step(1)
            total += contacts.impulse
            if total and not contacts.touched:
                break
        fall = np.array([0.0, 0.0, -9.81]) * (sim.time() - begin)
        change = MASS * (np.array(ball.velocity()[0]) - before - fall)
    assert change[0] < -MASS * SPEED
    assert total == pytest.approx(np.linalg.norm(change), rel=0.02)


def test_the_floor_does_not_count_and_the_other_body_is_named():
    with morse.load(arena) as sim:
        contacts = sim.contacts("robot")
        heard = []
        contacts.subscribe(heard.append)
        sim.robot.motion.publish({"v": 0.0, "w": 0.5})
        sim.step(60)
        assert not contacts.touched
        assert contacts.impulse == 0.0
        sim.robot.motion.publish({"v": 2.0, "w": 0.0})
        sim.step(180)
        assert contacts.touched
        assert contacts.impulse > 0.0
        assert {contact.other for contact in contacts.events} <= {f"Wall{k}" for k in range(4)}
        assert [contact.other for contact in heard] == [contact.other for contact in contacts.events]
        assert all(math.isfinite(contact.begin) and contact.begin > 1.0 for contact in heard)
        sim.robot.motion.publish({"v": -1.0, "w": 0.0})
        sim.step(30)
        assert contacts.events[0].end is not None
        sim.step(1)
        assert not contacts.touched


def test_a_touch_within_a_step_is_not_lost():
    with morse.load(arena) as sim:
        contacts = sim.robot.contacts()
        sim.place("robot", [1.65, 0.0, 0.0])
        sim.step(1)
        sim.robot.motion.publish({"v": 3.0, "w": 0.0})
        sim.step(3)
        sim.robot.motion.publish({"v": -3.0, "w": 0.0})
        touched_while_there = contacts.touched
        sim.step(20)
        assert touched_while_there or contacts.touched
        sim.step(5)
        assert not contacts.touched


def test_a_sleeping_body_still_touches_what_it_leans_on():
    def leaning():
        from morse.builder import Environment, Robot

        robot = Robot(name="lower")
        body(robot, mass=5.0)
        upper = Robot(name="upper")
        body(upper, mass=1.0, radius=0.1)
        upper.translate(0.0, 0.0, 0.31)
        Environment("empty")

    with morse.load(leaning) as sim:
        contacts = sim.upper.contacts()
        sim.step(600)
        rest = contacts.impulse
        assert [contact.other for contact in contacts.events if contact.end is None] == ["lower"]
        sim.step(60)
        # it carries its weight for one second
        assert contacts.impulse == pytest.approx(1.0 * 9.81, rel=0.1)
        assert rest > 0.0
        state = sim.save()
        sim.restore(state)
        sim.step(60)
        assert contacts.impulse == pytest.approx(1.0 * 9.81, rel=0.1)


def test_watching_changes_nothing():
    hashes = []
    for watches in (False, True):
        with morse.load(arena, seed=1) as sim:
            if watches:
                sim.robot.contacts()
            sim.robot.motion.publish({"v": 1.5, "w": 0.4})
            sim.step(200)
            hashes.append(sim.state_hash())
    assert hashes[0] == hashes[1]


def test_a_robot_that_is_placed_leaves_its_contacts_behind():
    with morse.load(arena) as sim:
        contacts, wall = sim.robot.contacts(), None
        sim.robot.motion.publish({"v": 2.0, "w": 0.0})
        for _ in range(300):
            sim.step(1)
            if contacts.touched:
                wall = contacts.events[0]
                break
        assert wall is not None
        touching, arrived = sim.contacts(wall.other), sim.time()
        sim.step(1)
        assert touching.touched
        sim.place("robot", [0.0, 0.0, 0.0])
        assert wall.end == pytest.approx(arrived + 1.0 / 60.0)
        sim.step(6)
        assert not contacts.touched
        assert not touching.touched


def test_contacts_of_a_batch():
    with morse.batch(arena, 3) as many:
        drive, hit = many.command("robot.motion", "v", "w"), many.contacts("robot")
        drive[:] = [[2.0, 0.0], [0.0, 0.0], [-2.0, 0.0]]
        many.step(90)
        assert hit.tolist() == [True, False, True]
        assert hit.impulse.shape == (3,)
        assert (np.asarray(hit.impulse) > 0.0).tolist() == [True, False, True]
        many.restart(0)
        assert hit.tolist() == [False, False, True]


# -- rows that the kernel runs together have the bits of single simulations, at whatever time somebody looks

FIELDS = {"robot.pose": ("x", "y", "yaw"), "robot.laser": ("range_list",), "robot.gps": ("x", "z")}
PLACES = [(0.0, 0.0, 0.0), (1.2, 0.5, 2.0), (-1.0, -1.5, -1.0)]


def yard():
    """A planar robot with sensors that are mounted apart, among walls and a crate."""
    from morse.builder import GPS, Environment, MotionVW, Pose, Robot, Sick

    robot, laser, gps = Robot(name="robot"), Sick("laser"), GPS("gps")
    body(robot)
    laser.translate(0.1, 0.0, 0.2)
    laser.rotate(z=0.3)
    laser.level("range")
    gps.translate(0.1, 0.2, 0.3)
    gps.frequency(7)
    for part in (MotionVW("motion"), laser, gps, Pose("pose")):
        robot.append(part)
    block("Crate", -1.0, 0.3, 0.2, 0.2, static=False)
    for number, wall in enumerate([(2.5, 0.0, 0.1, 2.5), (-2.5, 0.0, 0.1, 2.5), (0.0, 2.5, 2.5, 0.1)]):
        block(f"Wall{number}", *wall)
    Environment("empty")


speeds = st.one_of(st.sampled_from([0.0, -0.0, 0.2]), st.floats(-2.0, 2.0).map(lambda speed: round(speed, 2)))
#: of a row before a step
acts = st.one_of(
    st.tuples(st.just("drive"), st.tuples(speeds, speeds)),
    st.tuples(st.just("drive"), st.tuples(speeds, speeds)),
    st.tuples(st.sampled_from(["idle", "place", "restart", "measure", "save"]), st.sampled_from(PLACES)),
)
steps = st.tuples(acts, acts, acts, st.sampled_from([6, 6, 6, 1, 20, 100]), st.booleans())


@settings(max_examples=examples(40))
@given(script=st.lists(steps, min_size=2, max_size=12), published=st.booleans())
def test_rows_that_nobody_looks_at(script, published):
    alone = [morse.load(yard, seed=4 + row) for row in range(3)]
    contacts = [sim.robot.contacts() for sim in alone]
    with morse.batch(yard, 3, seed=4) as many:
        drive, hit = many.command("robot.motion", "v", "w"), many.contacts("robot")
        columns = {name: many.read(name, *fields) for name, fields in FIELDS.items()}
        drive[:] = 0.4, 0.9
        commands = [(0.4, 0.9)] * 3
        for *each, ticks, measure in [(*[("idle", None)] * 3, 30, True), *script]:
            for row, ((kind, value), sim) in enumerate(zip(each, alone, strict=True)):
                if kind == "drive":
                    drive[row] = commands[row] = value
                elif kind == "place":
                    many.place(row, "robot", value)
                    sim.robot.place(value)
                elif kind == "restart":
                    many.restart(row)
                    sim.restart(sim.seed())
                    commands[row] = None
                elif kind == "measure":
                    many.measure(row)
                    sim.measure()
                elif kind == "save":
                    assert many.save(row)[0].hash() == sim.state_hash()
            if published and ticks == 20:
                assert many[1].time() == alone[1].time()
            many.step(ticks, measure=measure)
            for row, sim in enumerate(alone):
                if commands[row] and ticks:
                    sim.robot.motion.publish(dict(zip("vw", commands[row], strict=True)))
                sim.step(ticks, measure=measure)
                assert (hit[row], hit.impulse[row]) == (contacts[row].touched, contacts[row].impulse)
                for name, array in columns.items():
                    data = sim.robot.parts[name.split(".")[1]].data
                    values = np.hstack([data[field] for field in FIELDS[name]])
                    if len(values) == array.shape[1]:  # a scanner that has not measured yet has no data
                        assert (array[row] == values).all(), name
        for row, sim in enumerate(alone):
            assert many.save(row)[0].hash() == sim.state_hash()
            for part in ("pose", "laser", "gps", "motion"):
                assert repr(many[row].robot.parts[part].data) == repr(sim.robot.parts[part].data)
    for sim in alone:
        sim.close()


@pytest.mark.skipif(library() is None, reason="without the kernel, each row runs on its own")
def test_rows_go_on_together():
    """Without this, the test above compares nothing."""
    with morse.batch(arena, 4) as many:
        drive = many.command("robot.motion", "v", "w")
        many.read("robot.pose", "x", "y")
        drive[:] = 0.3, 0.9
        many.step(30, measure=True)
        simulation = many[2]
        many.step(6, measure=True)
        steps, run = [], type(simulation).step
        try:
            type(simulation).step = lambda self, *a, **k: steps.append(self) or run(self, *a, **k)
            many.step(6, measure=True)
        finally:
            type(simulation).step = run
        assert steps == [simulation], "who was handed out is stepped, the others are not"


@pytest.mark.skipif(library() is None, reason="without the kernel, each row runs on its own")
def test_rows_along_a_wall_go_on_together():
    """A wall that is near, but that the robot does not touch in the next tick, is no reason to run alone."""
    with morse.batch(arena, 2) as many:
        drive, hit = many.command("robot.motion", "v", "w"), many.contacts("robot")
        many.read("robot.pose", "x", "y")
        drive[:] = 1.0, 0.0
        many.place(None, "robot", [-1.5, 1.9 - 0.2 - 0.06, 0.0])
        many.step(30, measure=True)
        steps, run = [], morse.Simulation.step
        try:
            morse.Simulation.step = lambda self, *a, **k: steps.append(self) or run(self, *a, **k)
            for _ in range(10):
                many.step(6, measure=True)
                assert not hit.any()
        finally:
            morse.Simulation.step = run
        assert not steps
