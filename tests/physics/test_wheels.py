"""Wheeled robots."""

import math

import pytest
from worlds import box, ground, node, rigid, run, scene, sphere

from morse.core.mathutils import Vector
from morse.physics import World
from morse.scene import CollisionShape, PhysicsType, ShapeKind

RADIUS, TRACK = 0.1, 0.34
AXLE = Vector([0.05, 0, 0])


def wheeled(name="robot", caster=0.04, **pose):
    pose = {"at": (0, 0, RADIUS)} | pose
    body = rigid(name, box(0.45, 0.3, 0.15), mass=9.0, **pose)
    body.shapes[0].position = (-0.03, 0, 0.06)
    wheel = CollisionShape(ShapeKind.CYLINDER, (RADIUS, 0.02))
    for side, y in (("Wheel_L", TRACK / 2), ("Wheel_R", -TRACK / 2)):
        # modelled as in Blender: a cylinder along Z, rotated onto its side
        body.attach(
            node(f"{name}.{side}", wheel, at=(0.05, y, 0), turned=(math.pi / 2, 0, 0), kind=PhysicsType.RIGID_BODY)
        )
    body.attach(node(f"{name}.CasterWheel", sphere(0.04), at=(-0.17, 0, caster - RADIUS), kind=PhysicsType.RIGID_BODY))
    return body


@pytest.fixture
def driven():
    body = wheeled()
    made = scene(ground(), body, robots=[body])
    made.components[0].options["wheels"] = ["robot.Wheel_L", "robot.Wheel_R"]
    return World(made)


def test_wheels_know_their_size_and_side(driven):
    left, right = driven.game_object("robot").wheels()
    assert left.radius == pytest.approx(RADIUS)
    assert (left.offset_y, right.offset_y) == pytest.approx((TRACK / 2, -TRACK / 2))


def test_a_wheel_that_is_turned_about_its_axle_has_the_same_size():
    body = wheeled()
    left = next(child for child in body.children if child.name == "robot.Wheel_L")
    c = math.sqrt(0.5)
    left.shapes[0].rotation = (c, -c, 0.0, c, c, 0.0, 0.0, 0.0, 1.0)
    made = scene(ground(), body, robots=[body])
    made.components[0].options["wheels"] = ["robot.Wheel_L", "robot.Wheel_R"]
    assert World(made).game_object("robot").wheels()[0].radius == pytest.approx(RADIUS)


def test_a_resting_robot_does_not_creep(driven):
    run(driven, 3.0)
    assert tuple(driven.game_object("robot").worldPosition) == pytest.approx((0, 0, RADIUS), abs=5e-3)


@pytest.mark.parametrize(("v", "w"), [(0.5, 0.0), (0.5, 0.3), (0.0, 0.5), (-0.4, 0.2)])
def test_differential_speeds_give_speed_and_rate(driven, v, w):
    robot = driven.game_object("robot")
    left, right = robot.wheels()

    def drive():
        left.set_speed((v - w * TRACK / 2) / RADIUS)
        right.set_speed((v + w * TRACK / 2) / RADIUS)

    run(driven, 1.0, drive)
    total = 0.0
    heading = robot.worldOrientation.to_euler().z
    # the point between the wheels moves on the circle
    start, angle = robot.worldTransform @ AXLE, (left.angle + right.angle) / 2
    for _ in range(240):
        drive()
        driven.step()
        now = robot.worldOrientation.to_euler().z
        total += math.remainder(now - heading, 2 * math.pi)
        heading = now
    assert total / 4.0 == pytest.approx(w, abs=0.02 * max(abs(w), 0.1))
    odometry = ((left.angle + right.angle) / 2 - angle) * RADIUS
    assert odometry == pytest.approx(4.0 * v, abs=0.02)
    chord = (robot.worldTransform @ AXLE - start).length
    expected = abs(v) * 4.0 if w == 0 else abs(2 * v / w * math.sin(w * 2.0))
    assert chord == pytest.approx(expected, rel=0.03, abs=0.02)


def test_the_caster_is_no_driven_wheel(driven):
    assert len(driven.game_object("robot").wheels()) == 2


@pytest.mark.parametrize("below", [0.0, 0.002, 0.005])
def test_a_caster_that_reaches_too_low_lifts_no_wheel(below):
    body = wheeled(caster=0.04 - below)
    made = scene(ground(), body, robots=[body])
    made.components[0].options["wheels"] = ["robot.Wheel_L", "robot.Wheel_R"]
    world = World(made)
    robot = world.game_object("robot")

    def drive():
        for wheel in robot.wheels():
            wheel.set_speed(0.4 / RADIUS)

    run(world, 1.0, drive)
    start = robot.worldPosition.x
    run(world, 2.0, drive)
    assert robot.worldPosition.x - start == pytest.approx(0.8, abs=0.02)


@pytest.mark.parametrize(("friction", "climbs"), [(0.1, False), (0.8, True)])
def test_the_property_friction_is_that_of_the_wheels(friction, climbs):
    # a slope of tan 0.3 = 0.31, and 4/5 of the weight on the driven wheels
    body = wheeled(at=(0, 0, 0.2), turned=(0, -0.3, 0))
    body.properties["Friction"] = friction
    made = scene(node("Slope", box(40, 40, 1), at=(0, 0, -0.5), turned=(0, -0.3, 0)), body, robots=[body])
    made.components[0].options["wheels"] = ["robot.Wheel_L", "robot.Wheel_R"]
    world = World(made)
    robot = world.game_object("robot")
    run(world, 1.0)
    start = robot.worldPosition.z

    def drive():
        for wheel in robot.wheels():
            wheel.set_speed(0.5 / RADIUS)

    run(world, 3.0, drive)
    assert (robot.worldPosition.z > start + 0.2) == climbs
