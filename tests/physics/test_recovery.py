"""No number ends a simulation: absurd values are refused, a diverged body is reset alone, the others continue."""

import contextlib
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from worlds import bits, box, ground, rigid, robot, run, scene, sphere, world

from morse.physics import UnstableError, World
from morse.physics.poses.convert import RUNAWAY_SPEED
from morse.scene import ComponentDeclaration
from tests.kit.effort import examples

pytestmark = pytest.mark.long

ABSURD = [1e11, -1e150, 1e308, math.inf, -math.inf, math.nan]


def crowd():
    """Three adjacent boxes in contact, one on top, one far away, and a gliding robot."""
    body = robot("robot", at=(-4, 0, 0.25))
    boxes = [rigid(f"b{i}", box(0.3, 0.3, 0.3), at=(0.3 * i, 0, 0.15)) for i in range(3)]
    top = rigid("top", box(0.3, 0.3, 0.3), at=(0.3, 0, 0.45))
    return world(ground(), body, *boxes, top, rigid("far", sphere(0.2), at=(8, 8, 4)), robots=[body])


def drive(w):
    w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0), ground=True)


# absurd values are refused --------------------------------------------------------------------------


@pytest.fixture(scope="module")
def unchanged():
    """The same world for all values that are refused: each test proves that it is as it was."""
    return crowd()


@pytest.mark.parametrize("value", ABSURD)
@pytest.mark.parametrize(
    "attribute",
    [
        "worldPosition", "localPosition", "position", "worldLinearVelocity", "localLinearVelocity",
        "worldAngularVelocity", "localAngularVelocity", "linearVelocity", "angularVelocity",
    ],
)  # fmt: skip
def test_an_absurd_attribute_is_refused_and_changes_nothing(unchanged, attribute, value):
    w = unchanged
    before = bits(w.get_state())
    with pytest.raises(ValueError, match="three finite numbers from"):
        setattr(w.game_object("b1"), attribute, (0.0, value, 0.0))
    assert bits(w.get_state()) == before


@pytest.mark.parametrize("value", ABSURD)
@pytest.mark.parametrize(
    "act",
    [
        lambda o, v: o.applyForce((v, 0, 0)),
        lambda o, v: o.applyTorque((v, 0, 0), True),
        lambda o, v: o.applyMovement((0, v, 0)),
        lambda o, v: o.applyRotation((0, v, 0)),
        lambda o, v: o.drive((v, 0, 0), (0, 0, 0)),
        lambda o, v: o.drive((0, 0, 0), (0, 0, v), ground=True),
        lambda o, v: o.set_pose((v, 0, 0), (1, 0, 0, 0, 1, 0, 0, 0, 1)),
        lambda o, v: o.set_pose((0, 0, 0), (v, 0, 0, 0, 1, 0, 0, 0, 1)),
        lambda o, v: o.set_local_pose((0, 0, v), (1, 0, 0, 0, 1, 0, 0, 0, 1)),
        lambda o, v: o.set_velocity((v, 0, 0), None),
        lambda o, v: o.set_velocity(None, (v, 0, 0)),
        lambda o, v: setattr(o, "worldOrientation", [[1, 0, 0], [0, v, 0], [0, 0, 1]]),
        lambda o, v: setattr(o, "worldTransform", [[1, 0, 0, v], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]),
        lambda o, v: o.pull((v, 0, 0), (0, 0, 0), 100.0, 20.0, 50.0),
    ],
)
def test_an_absurd_number_is_refused_and_changes_nothing(unchanged, act, value):
    w = unchanged
    before = bits(w.get_state())
    with pytest.raises(ValueError, match="finite"):
        act(w.game_object("b1"), value)
    assert bits(w.get_state()) == before


def test_the_message_says_what_how_far_and_what_was_given():
    with pytest.raises(
        ValueError, match=r"a position is three finite numbers from -1e\+07 to 1e\+07 m, not \[1e\+20, 0"
    ):
        crowd().game_object("b1").worldPosition = [1e20, 0, 0]


def test_steps_beyond_the_limit_are_refused():
    w = crowd()
    far = w.game_object("far")
    far.worldPosition = (9e6, 0, 0)
    with pytest.raises(ValueError, match="position"):
        far.applyMovement((9e6, 0, 0))


def test_what_is_within_the_limits_is_obeyed():
    w = crowd()
    far = w.game_object("far")
    far.worldPosition = (9e6, 0, 100)
    far.worldLinearVelocity = (9e4, 0, 0)
    w.step()
    assert far.worldPosition.x == pytest.approx(9e6 + 9e4 / 60)
    assert not w.recoveries


@pytest.mark.parametrize("speed", [1e300, -1e300, math.inf])
def test_a_wheel_turns_as_fast_as_it_can(speed):
    cart = rigid("cart", box(0.5, 0.3, 0.1), at=(0, 0, 0.15), mass=8.0)
    for side, y in (("left", 0.2), ("right", -0.2)):
        cart.attach(rigid(f"{side}_wheel", sphere(0.1), at=(0.1, y, -0.05), mass=0.5))
    made = scene(ground(), cart)
    wheels = {"wheels": ["left_wheel", "right_wheel"]}
    made.components.append(ComponentDeclaration(cart, "robot", "morse.core.robot.Robot", cart, options=wheels))
    w = World(made)
    for wheel in w.game_object("cart").wheels():
        wheel.set_speed(speed)
    run(w, 2.0)
    assert np.isfinite(w.data.qpos).all()
    with pytest.raises(ValueError, match="nan"):
        w.game_object("cart").wheels()[0].set_speed(math.nan)


# divergence -----------------------------------------------------------------------------------------


def spoil(w, name, what, value):
    """Writes into the engine without limits, like an internal error."""
    slot = w.slots[w.named[name]]
    if what == "position":
        w.data.qpos[slot.qpos] = value
    elif what == "velocity":
        w.data.qvel[slot.dof] = value
    elif what == "spin":
        w.data.qvel[slot.dof + 3] = value
    elif what == "force":
        w.data.xfrc_applied[slot.body, 0] = value
        w.has_forces = True


@pytest.mark.parametrize("value", [1e13, 1e150, 1e300, math.inf, math.nan])
@pytest.mark.parametrize("what", ["position", "velocity", "spin", "force"])
@pytest.mark.parametrize("name", ["b1", "top", "far"])
def test_the_body_that_blows_up_is_put_back_and_the_others_go_on(name, what, value, caplog):
    w = crowd()
    for _ in range(40):
        drive(w)
        w.step()
    assert w.gliding.glides
    places = {n: w.game_object(n).worldPosition.copy() for n in w.names}
    spoil(w, name, what, value)
    drive(w)
    w.step()
    assert [entry.body for entry in w.recoveries] == [name]
    assert w.recovered == 1
    assert [record.levelname for record in caplog.records if f"'{name}'" in record.message] == ["ERROR"]
    assert np.isfinite(w.data.qpos).all()
    if what != "position":
        assert (w.game_object(name).worldPosition - places[name]).length < 0.01
    for _ in range(60):
        drive(w)
        w.step()
    assert w.recovered == 1
    assert w.game_object("robot").worldPosition.x == pytest.approx(places["robot"].x + 61 / 120, abs=0.01)
    for other in ("b0", "b2"):
        assert (w.game_object(other).worldPosition - places[other]).length < 0.02


def test_a_body_that_sleeps_far_away_is_not_woken():
    w = world(ground(), *(rigid(f"b{i}", box(0.3, 0.3, 0.3), at=(4 * i, 0, 0.15)) for i in range(3)))
    run(w, 2.0)
    before = w.positions[1]
    spoil(w, "b0", "velocity", math.nan)
    w.step()
    assert [entry.body for entry in w.recoveries] == ["b0"]
    assert w.positions[1] == before
    assert w.data.tree_asleep[1] >= 0


def test_several_that_blow_up_at_once_are_all_put_back():
    w = crowd()
    run(w, 0.5)
    for name in ("b0", "b2", "far", "robot"):
        spoil(w, name, "velocity", math.inf)
    w.step()
    assert sorted(entry.body for entry in w.recoveries) == ["b0", "b2", "far", "robot"]
    run(w, 1.0)
    assert w.recovered == 4


def test_many_that_blow_up_at_once_are_all_put_back():
    balls = [rigid(f"ball{i}", sphere(0.1), at=(i % 10, i // 10, 0.1)) for i in range(30)]
    w = world(ground(), *balls)
    run(w, 0.2)
    w.data.qvel[:] = math.nan
    w.step()
    assert w.recovered == 30
    run(w, 0.2)
    assert w.recovered == 30


def test_an_event_is_one_line_however_long_it_lasts(caplog):
    w = crowd()
    run(w, 0.5)
    for _ in range(50):
        spoil(w, "b1", "velocity", math.nan)
        w.step()
    assert w.recovered == 50
    assert len(w.recoveries) == 1
    assert sum("'b1'" in record.message for record in caplog.records) == 1
    run(w, 2.0)
    spoil(w, "b1", "velocity", math.nan)
    w.step()
    assert len(w.recoveries) == 2


def test_the_list_of_recoveries_does_not_grow_for_ever():
    w = world(ground(), rigid("b1", box(0.3, 0.3, 0.3), at=(0, 0, 0.15)))
    for _ in range(120):
        w.data.time += 10.0
        spoil(w, "b1", "velocity", math.nan)
        w.step()
    assert w.recovered == 120
    assert len(w.recoveries) == 100


def test_wheels_are_put_back_with_their_robot():
    cart = rigid("cart", box(0.5, 0.3, 0.1), at=(0, 0, 0.15), mass=8.0)
    for side, y in (("left", 0.2), ("right", -0.2)):
        cart.attach(rigid(f"{side}_wheel", sphere(0.1), at=(0.1, y, -0.05), mass=0.5))
    made = scene(ground(), cart)
    wheels = {"wheels": ["left_wheel", "right_wheel"]}
    made.components.append(ComponentDeclaration(cart, "robot", "morse.core.robot.Robot", cart, options=wheels))
    w = World(made)
    run(w, 0.5)
    w.data.qvel[w.slots[w.named["left_wheel"]].dof] = math.nan
    w.data.qpos[w.slots[w.named["right_wheel"]].qpos] = math.inf
    w.step()
    assert np.isfinite(w.data.qpos).all()
    assert w.recoveries
    run(w, 1.0, lambda: [wheel.set_speed(4.0) for wheel in w.game_object("cart").wheels()])
    assert w.game_object("cart").worldPosition.x > 0.2


def test_a_runaway_is_stopped_before_it_is_no_number():
    w = crowd()
    spoil(w, "far", "velocity", 10 * RUNAWAY_SPEED)
    w.step()
    assert "moves at 1e+07" in w.recoveries[0].what
    assert w.game_object("far").worldPosition.x == pytest.approx(8.0)


def test_what_cannot_be_mended_ends_with_the_name_of_a_body():
    w = crowd()
    # gravity itself is NaN: resetting bodies cannot help
    w.model.opt.gravity[2] = math.nan
    with pytest.raises(UnstableError, match="diverged"):
        w.step()


def test_a_recovery_is_repeatable_to_the_bit():
    def final():
        w = crowd()
        run(w, 0.4)
        spoil(w, "b1", "spin", 1e200)
        run(w, 0.6, lambda: drive(w))
        return bits(w.get_state())

    assert final() == final()


numbers = st.floats(allow_nan=True, allow_infinity=True)
vectors = st.tuples(numbers, numbers, numbers)
deeds = st.sampled_from(
    [
        lambda o, a, b: setattr(o, "worldPosition", a),
        lambda o, a, b: setattr(o, "worldOrientation", a),
        lambda o, a, b: setattr(o, "worldLinearVelocity", a),
        lambda o, a, b: setattr(o, "localAngularVelocity", a),
        lambda o, a, b: o.applyForce(a, True),
        lambda o, a, b: o.applyTorque(a),
        lambda o, a, b: o.applyRotation(a),
        lambda o, a, b: o.drive(a, b),
        lambda o, a, b: o.drive(a, b, ground=True),
        lambda o, a, b: o.drive(a, b, position=True),
        lambda o, a, b: o.pull(a, b, a[0], b[0], a[1]),
        lambda o, a, b: o.suspendDynamics(),
    ]
)


@settings(max_examples=examples(60), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.lists(st.tuples(deeds, st.sampled_from(["robot", "b0", "b1", "far"]), vectors, vectors), max_size=12))
def test_whatever_is_asked_for_the_world_goes_on(asked):
    w = crowd()
    for deed, name, a, b in asked:
        with contextlib.suppress(ValueError):
            deed(w.game_object(name), a, b)
        w.step()
    run(w, 0.2)
    for position, rotation in zip(w.positions, w.rotations, strict=True):
        assert np.isfinite(position).all()
        assert np.isfinite(rotation).all()


@pytest.mark.parametrize("speed", [1e5, 1e3])
def test_the_fastest_that_is_allowed_ends_nothing(speed):
    w = crowd()
    for tick in range(200):
        w.game_object("robot").drive((speed, 0, 0), (0, 0, speed * (tick % 2)), ground=True)
        w.game_object("far").applyForce((1e9, 0, 1e9))
        w.game_object("b0").applyTorque((1e9, 0, 1e9))
        w.step()
    assert np.isfinite(w.data.qpos).all()
    assert all(math.isfinite(v) for position in w.positions for v in position)
