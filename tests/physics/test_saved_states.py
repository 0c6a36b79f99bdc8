"""A restored state has a bit-identical future, in any world of the scene."""

import random
import re

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st
from worlds import bits, box, ground, node, rigid, robot, scene, sphere, world

from morse.physics import World
from morse.physics.state.saved import SavedAttachments, SavedGrip
from morse.scene import Node
from tests.kit.effort import examples
from tests.kit.programs import new_processes

pytestmark = pytest.mark.long

IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)


def make(blocks):
    """A gliding robot with an eye, a wheeled, a kinematic, a hovering robot without shape, a wall, and blocks."""
    glider = robot("glider", at=(-2, 0, 0.25))
    eye = Node("eye", location=[0.2, 0.0, 0.3])
    eye.shapes = [sphere(0.05)]
    glider.attach(eye)
    cart = rigid("cart", box(0.5, 0.3, 0.1), at=(0, 2, 0.15), mass=8.0)
    for name, y in (("left_wheel", 0.2), ("right_wheel", -0.2)):
        cart.attach(rigid(name, sphere(0.1), at=(0.1, y, -0.05), mass=0.5))
    cart.attach(node("caster", sphere(0.05), at=(-0.2, 0, -0.1)))
    pusher = node("pusher", box(0.2, 0.2, 0.2), at=(3, 3, 0.2))
    spirit = Node("spirit", location=[0.0, 0.0, 2.0])
    wall = node("wall", box(0.2, 3, 1), at=(1.5, -2, 0.5))
    boxes = [rigid(f"b{i}", box(0.3, 0.3, 0.3), at=(x, y, z)) for i, (x, y, z) in enumerate(blocks)]
    made = scene(ground(), glider, cart, pusher, spirit, wall, *boxes, robots=[glider, cart, pusher, spirit])
    next(c for c in made.components if c.node is cart).options["wheels"] = ["left_wheel", "right_wheel"]
    return World(made)


class Hands:
    """Acts on a world in each tick, as determined by a seed: the same in every world."""

    def __init__(self, seed, blocks):
        self.seed, self.names = seed, [f"b{i}" for i in range(blocks)]

    def act(self, w, tick):
        chance = random.Random(self.seed * 100_003 + tick)
        glider, cart = w.game_object("glider"), w.game_object("cart")
        if tick % 97 < 80:
            glider.drive((0.6, 0, 0), (0, 0, 0.3 * (tick // 40 % 3 - 1)), ground=True)
        for number, wheel in enumerate(cart.wheels()):
            wheel.set_speed(4.0 + number)
        w.game_object("pusher").drive((0.3, 0, 0), (0, 0, 0.2), position=True)
        w.game_object("spirit").drive((0.3, 0, 0.1), (0, 0.1, 0.2))
        if chance.random() < 0.15:
            getattr(self, chance.choice(self.DEEDS))(w, chance)

    DEEDS = (
        "hold", "let_go", "suspend", "resume", "teleport", "push", "hit", "lighten", "turn_eye", "hide", "name",
        "move_wall", "jump", "pull",
    )  # fmt: skip

    def any(self, w, chance):
        return w.game_object(chance.choice([*self.names, "glider", "cart"]))

    def block(self, w, chance):
        return w.game_object(chance.choice(self.names)) if self.names else w.game_object("glider")

    def hold(self, w, chance):
        if self.names:
            self.block(w, chance).setParent(w.game_object(chance.choice(["glider", "eye", "cart"])))

    def let_go(self, w, chance):
        self.block(w, chance).removeParent()

    def suspend(self, w, chance):
        self.block(w, chance).suspendDynamics()

    def resume(self, w, chance):
        self.block(w, chance).restoreDynamics()

    def teleport(self, w, chance):
        self.block(w, chance).worldPosition = (chance.uniform(-3, 3), chance.uniform(-3, 3), chance.uniform(0.2, 2))

    def jump(self, w, chance):
        glider = w.game_object("glider")
        x, y, z = glider.worldPosition
        glider.worldPosition = (x, y, z + chance.choice([0.0, 0.0, 0.3]))

    def push(self, w, chance):
        self.any(w, chance).applyForce((chance.uniform(-50, 50), 0, 30), chance.random() < 0.5)

    def hit(self, w, chance):
        self.block(w, chance).worldLinearVelocity = (chance.uniform(-3, 3), 1, 1)

    def lighten(self, w, chance):
        self.block(w, chance).disable_gravity()

    def turn_eye(self, w, chance):
        w.game_object("eye").localOrientation = (0, 0, chance.uniform(-1, 1))

    def hide(self, w, chance):
        self.any(w, chance).setVisible(chance.random() < 0.5)

    def name(self, w, chance):
        self.any(w, chance)["Label"] = chance.choice(["a", 1, 1.0, True, [1, 2]])

    def move_wall(self, w, chance):
        w.game_object("wall").worldPosition = (1.5, chance.uniform(-3, 3), 0.5)

    def pull(self, w, chance):
        self.block(w, chance).pull((0.1, 0, 0), (0, 0, 1), 100.0, 20.0, 50.0)


def go_on(state, blocks, seed, first, last):
    """The states at the end of some ticks after a state, in a new world."""
    w, hands = make(blocks), Hands(seed, len(blocks))
    if state is not None:
        w.set_state(state)
    states = []
    for tick in range(first, last):
        hands.act(w, tick)
        w.step()
        states.append(bits(w.get_state()))
    return states


places = st.lists(
    st.tuples(*[st.sampled_from([-1.5, -0.5, 0.5, 1.0])] * 2, st.sampled_from([0.15, 0.16, 0.5])),
    max_size=4,
    unique=True,
)


@settings(max_examples=examples(40), deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(places, st.integers(0, 10_000), st.integers(1, 150), st.booleans())
@example([(-1.5, 0.5, 0.15), (-0.5, -1.5, 0.15)], 6859, 131, False)  # a wall moves beside a block without gravity
def test_a_saved_state_goes_on_as_without_a_break(blocks, seed, at, act_before_saving):
    w, hands = make(blocks), Hands(seed, len(blocks))
    for tick in range(at):
        hands.act(w, tick)
        w.step()
    first = at
    if act_before_saving:
        # commands, forces and poses that wait for the next tick are saved as well
        hands.act(w, at)
    saved = w.get_state()
    fresh = make(blocks)
    fresh.set_state(saved)
    assert bits(fresh.get_state()) == bits(saved)
    for tick in range(first, first + 60):
        for one in (w, fresh):
            if tick > first or not act_before_saving:
                hands.act(one, tick)
            one.step()
        assert bits(one.get_state()) == bits(w.get_state()), tick
    assert fresh.positions == w.positions
    assert fresh.rotations == w.rotations


BLOCKS = [(0.5, 0.5, 0.15), (0.5, 0.5, 0.5), (-1.5, 1.0, 0.15)]


def test_another_process_goes_on_with_the_same_bits():
    w, hands = make(BLOCKS), Hands(7, len(BLOCKS))
    for tick in range(120):
        hands.act(w, tick)
        w.step()
    saved = w.get_state()
    expected = go_on(saved, BLOCKS, 7, 120, 200)
    with new_processes() as pool:
        assert pool.apply(go_on, (saved, BLOCKS, 7, 120, 200)) == expected
    without_break = go_on(None, BLOCKS, 7, 0, 200)
    assert without_break[120:] == expected


# contents of a state ---------------------------------------------------------------------------


def glided(ticks=60):
    w = make(BLOCKS)
    for _ in range(ticks):
        w.game_object("glider").drive((0.5, 0, 0), (0, 0, 0), ground=True)
        w.step()
    return w


def test_a_world_that_holds_something_has_another_state():
    holding, free = make(BLOCKS), make(BLOCKS)
    for w in (holding, free):
        w.step()
    # collisions are disabled for a held body: enable them, to test only the attachment
    holding.attachments.set_state(_held("b0", "eye"), holding.objects_by_name)
    assert bits(holding.get_state()) != bits(free.get_state())
    assert holding.get_state()["attachments"]["held"][0]["holder"] == "eye"


def _held(slot, holder):
    return SavedAttachments([SavedGrip(slot, holder, (0.0, 0.0, 0.1), IDENTITY)], [])


@pytest.mark.parametrize(
    "change",
    [
        lambda w: w.game_object("b0").suspendDynamics(),
        lambda w: w.game_object("b0").setParent(w.game_object("glider")),
        lambda w: w.game_object("glider").drive((0.1, 0, 0), (0, 0, 0), ground=True),
        lambda w: w.game_object("b0").applyForce((1, 0, 0)),
        lambda w: w.game_object("b0").disable_gravity(),
        lambda w: w.game_object("b0").setVisible(False),
        lambda w: setattr(w.game_object("wall"), "worldPosition", (1.5, 0, 0.5)),
        lambda w: setattr(w.game_object("spirit"), "worldPosition", (1.5, 0, 0.5)),
        lambda w: setattr(w.game_object("eye"), "localOrientation", (0, 0, 1)),
        lambda w: w.game_object("eye").__setitem__("Label", "x"),
    ],
)
def test_every_change_is_in_the_state_and_is_taken_back(change):
    w = glided()
    before = w.get_state()
    change(w)
    assert bits(w.get_state()) != bits(before)
    w.set_state(before)
    assert bits(w.get_state()) == bits(before)
    positions, other = w.positions, glided()
    assert positions == other.positions


def test_a_state_is_a_copy():
    w = glided()
    state = w.get_state()
    text = bits(state)
    w.game_object("b0")["List"] = [1]
    Hands(1, 3).act(w, 1)
    for _ in range(30):
        w.step()
    assert bits(state) == text
    w.set_state(state)
    for _ in range(5):
        w.step()
    assert bits(state) == text


def test_lists_in_properties_are_not_shared_with_a_state():
    w = glided()
    w.game_object("b0")["List"] = [1]
    state = w.get_state()
    w.game_object("b0")["List"].append(2)
    w.set_state(state)
    assert w.game_object("b0")["List"] == [1]
    w.game_object("b0")["List"].append(3)
    w.set_state(state)
    assert w.game_object("b0")["List"] == [1]


def test_properties_that_are_no_plain_data_are_named_and_stay(caplog):
    w = glided()
    keep = object()
    w.game_object("b1")["Thing"] = keep
    w.game_object("b1")["Number"] = 5
    state = w.get_state()
    w.game_object("b1")["Number"] = 6
    assert "'Thing' of 'b1' is of type object" in caplog.text
    w.set_state(state)
    assert w.game_object("b1")["Thing"] is keep
    assert w.game_object("b1")["Number"] == 5


def test_rays_see_the_world_of_a_state():
    w = glided()
    bundle = w.rays.bundle(w.game_object("spirit"), [(1, 0, 0), (0, 0, -1)], 30.0)
    w.rays.cast([bundle])
    before, seen = w.get_state(), bundle.distances.tolist()
    w.game_object("wall").worldPosition = (1.5, 0, 2)
    w.game_object("b0").worldPosition = (0, 0, 1)
    w.step()
    w.rays.cast([bundle])
    assert bundle.distances.tolist() != seen
    w.set_state(before)
    w.rays.cast([bundle])
    assert bundle.distances.tolist() == seen


# refused states ---------------------------------------------------------------------------------


def damaged(path, value):
    def damage(state):
        part = state
        for key in path[:-1]:
            part = part[key]
        if value is None:
            del part[path[-1]]
        else:
            part[path[-1]] = value(part[path[-1]]) if callable(value) else value

    return damage


def filled(value):
    return lambda array: np.full_like(array, value)


@pytest.mark.parametrize(
    ("damage", "complaint"),
    [
        (damaged(["version"], 99), "version 99"),
        (damaged(["engine"], None), "engine"),
        (damaged(["engine", "integration"], None), "integration"),
        (damaged(["engine", "integration"], lambda a: a[:-1]), "numbers"),
        (damaged(["engine", "integration"], filled(np.nan)), "not finite"),
        (damaged(["engine", "integration"], [1.0, 2.0]), "array"),
        (damaged(["engine", "integration"], lambda a: a.astype(object)), "array"),
        (damaged(["engine", "asleep"], filled(0)), "cycles"),
        (damaged(["engine", "asleep"], filled(10_000)), "cycles"),
        (damaged(["engine", "asleep"], filled(-1000)), "cycles"),
        (damaged(["engine", "asleep"], lambda a: a[:2]), "trees"),
        (damaged(["engine", "contacts"], np.array([[0, 100_000]])), "geom"),
        (damaged(["engine", "contacts"], np.zeros(3)), "pairs"),
        (damaged(["engine", "model", "geom_pos"], None), "other arrays"),
        (damaged(["engine", "model", "geom_condim"], filled(77)), "dimensions"),
        (damaged(["engine", "model", "geom_pos"], lambda a: a.astype(np.float32)), "geom_pos"),
        (damaged(["slots"], ()), "another scene"),
        (damaged(["loose"], ["nobody"]), "nobody"),
        (damaged(["drives", "sliding"], ["nobody"]), "nobody"),
        (damaged(["gliding", "glides", 0, "floor"], 1234), "floor"),
        (damaged(["gliding", "stands", 0, "slot"], "b0"), "glide"),
        (damaged(["gliding", "tick"], "soon"), "tick"),
        (damaged(["gliding", "glides", 0, "up"], (0.0, 1.0)), "up"),
        (damaged(["gliding", "glides", 0, "speed"], float("inf")), "not finite"),
        (damaged(["objects"], {"nobody": {}}), "nobody"),
        (damaged(["objects"], {"b0": {"visible": 3}}), "visible"),
        (damaged(["attachments", "held"], [{"slot": "b0"}]), "holder"),
        (damaged(["surprise"], 1), "surprise"),
    ],
)
def test_a_damaged_state_is_refused_and_changes_nothing(damage, complaint):
    w = glided()
    assert w.get_state()["gliding"]["glides"]
    state = w.get_state()
    damage(state)
    for _ in range(3):
        w.step()
    before = bits(w.get_state())
    with pytest.raises(ValueError, match=re.escape(complaint)):
        w.set_state(state)
    assert bits(w.get_state()) == before


@pytest.mark.parametrize("alien", [None, 3, "state", b"", [], {}, {"version": 1}, object()])
def test_what_is_no_state_is_refused(alien):
    w = glided(3)
    with pytest.raises(ValueError, match="state"):
        w.set_state(alien)


def test_a_state_of_another_scene_is_refused():
    other = world(ground(), rigid("else", box(1, 1, 1), at=(0, 0, 2)))
    with pytest.raises(ValueError, match=r"another scene: .*differ"):
        glided(3).set_state(other.get_state())
