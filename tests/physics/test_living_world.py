"""Objects are added, removed and replaced while a world runs, without an effect on the others."""

import gc
import random
import time
import tracemalloc

import numpy as np
import pytest
from worlds import bits, box, ground, node, rigid, robot, run, scene, sphere, world

from morse.physics import World
from morse.physics.objects.object_world import RemovedError
from morse.scene import ComponentDeclaration, Node

pytestmark = pytest.mark.long


def declared(made, kind="robot", **options):
    return ComponentDeclaration(made, kind, "morse.core.robot.Robot", made, options=options)


def make_cart(name, at):
    cart = rigid(name, box(0.5, 0.3, 0.1), at=at, mass=8.0)
    for side, y in (("left", 0.2), ("right", -0.2)):
        cart.attach(rigid(f"{name}.{side}_wheel", sphere(0.1), at=(0.1, y, -0.05), mass=0.5))
    cart.attach(node(f"{name}.caster", sphere(0.05), at=(-0.2, 0, -0.1)))
    return cart, declared(cart, wheels=[f"{name}.left_wheel", f"{name}.right_wheel"])


def make_busy():
    """A gliding robot, a wheeled robot, a robot without forces, a held box, a sleeping stack, a falling ball."""
    glider = robot("glider", at=(-6, 0, 0.25))
    cart, wheels = make_cart("cart", (-6, 4, 0.15))
    pusher = node("pusher", box(0.2, 0.2, 0.2), at=(-3, 6, 0.2))
    spirit = Node("spirit", location=[0.0, 0.0, 5.0])
    others = [
        rigid("held", box(0.1, 0.1, 0.1), at=(-6, 0, 1.0), mass=0.1),
        rigid("low", box(0.3, 0.3, 0.3), at=(6, 6, 0.15)),
        rigid("high", box(0.3, 0.3, 0.3), at=(6, 6, 0.451)),
        rigid("ball", sphere(0.1), at=(6, -6, 3.0)),
        node("wall", box(0.2, 2, 1), at=(8, 0, 0.5)),
    ]
    made = scene(ground(), glider, cart, pusher, spirit, *others, robots=[glider, pusher, spirit])
    made.components.append(wheels)
    w = World(made)
    w.game_object("held").setParent(w.game_object("glider"))
    return w


BUSY = ["glider", "cart", "cart.left_wheel", "pusher", "spirit", "held", "low", "high", "ball", "wall"]


def act(w):
    w.game_object("glider").drive((0.5, 0, 0), (0, 0, 0.1), ground=True)
    w.game_object("pusher").drive((0.2, 0, 0), (0, 0, 0.1), position=True)
    w.game_object("spirit").drive((0.2, 0, 0.1), (0, 0, 0.1))
    for wheel in w.game_object("cart").wheels():
        wheel.set_speed(4.0)


def ticks(w, count):
    for _ in range(count):
        act(w)
        w.step()


def poses(w, names=tuple(BUSY)):
    return [(w.game_object(name).world_pose(), w.game_object(name).velocity()) for name in names]


# the others ---------------------------------------------------------------------------------------


def twins(count=90):
    changed, quiet = make_busy(), make_busy()
    for w in (changed, quiet):
        ticks(w, count)
    assert changed.gliding.glides
    assert min(changed.data.tree_asleep) < 0 <= max(changed.data.tree_asleep)
    return changed, quiet


def guests():
    return [rigid("comer", box(0.2, 0.2, 0.2), at=(15, 15, 3)), node("post", box(0.2, 0.2, 2), at=(15, -15, 1))]


def test_coming_and_going_changes_no_bit_of_the_others():
    changed, quiet = twins()
    changed.add(guests())
    assert poses(changed) == poses(quiet)
    changed.remove([changed.game_object("comer"), changed.game_object("post")])
    assert bits(changed.get_state()) == bits(quiet.get_state())
    for _ in range(20):
        for w in (changed, quiet):
            ticks(w, 3)
        assert bits(changed.get_state()) == bits(quiet.get_state())


def test_what_is_there_goes_on_to_rounding_beside_something_that_came():
    # the engine chooses the start of its solver for all bodies together: the last digits may differ
    changed, quiet = twins()
    changed.add(guests())
    for _ in range(20):
        for w in (changed, quiet):
            ticks(w, 3)
        for ours, theirs in zip(poses(changed), poses(quiet), strict=True):
            for one, other in zip(ours, theirs, strict=True):
                assert np.concatenate(one) == pytest.approx(np.concatenate(other), abs=1e-6)
    low = changed.game_object("low").slot
    assert changed.data.tree_asleep[changed.model.body_treeid[changed.slots[low].body]] >= 0


def test_objects_that_stay_are_the_same_objects():
    w = make_busy()
    before = [w.game_object(name) for name in BUSY]
    wheels = w.game_object("cart").wheels()
    w.remove([w.game_object("low")])
    w.add([rigid("another", box(0.2, 0.2, 0.2), at=(0, 0, 3))])
    for obj in before:
        if obj.name != "low":
            assert w.game_object(obj.name) is obj
            assert w.object_of(obj.node) is obj
    ticks(w, 30)
    assert before[BUSY.index("ball")].worldPosition.z < 3.0
    assert wheels[0].speed == pytest.approx(4.0, abs=0.5)
    assert wheels[0].object.name == "cart.left_wheel"


def test_a_state_with_guests_goes_on_in_a_fresh_world_of_that_scene():
    w = make_busy()
    ticks(w, 50)
    w.add([rigid("comer", box(0.2, 0.2, 0.2), at=(-5, 0.1, 3))])
    w.remove([w.game_object("high")])
    ticks(w, 50)
    saved = w.get_state()
    fresh = World(w.scene)
    fresh.set_state(saved)
    for _ in range(60):
        for one in (w, fresh):
            ticks(one, 1)
        assert bits(one.get_state()) == bits(w.get_state())


def test_a_state_from_before_is_of_another_scene():
    w = make_busy()
    before = w.get_state()
    w.add([rigid("comer", box(0.2, 0.2, 0.2), at=(0, 0, 3))])
    with pytest.raises(ValueError, match="another scene: comer"):
        w.set_state(before)


# adding -------------------------------------------------------------------------------------------


def test_a_robot_comes_with_its_wheels_and_drives():
    w = world(ground(), rigid("block", box(1, 1, 1), at=(5, 5, 0.5)))
    run(w, 1.0)
    cart, wheels = make_cart("cart", (0, 0, 0.15))
    come = w.add([cart], [wheels])
    assert [obj.name for obj in come] == ["cart", "cart.left_wheel", "cart.right_wheel", "cart.caster"]
    run(w, 2.0, lambda: [wheel.set_speed(5.0) for wheel in w.game_object("cart").wheels()])
    # the initial acceleration takes a little of the distance
    assert w.game_object("cart").worldPosition.x == pytest.approx(5.0 * 0.1 * 2.0, rel=0.1)


def test_a_robot_that_comes_glides():
    w = world(ground(), rigid("block", box(1, 1, 1), at=(5, 5, 0.5)))
    run(w, 0.5)
    body = robot("late", at=(0, 0, 0.25))
    w.add([body], [declared(body)])
    run(w, 1.0, lambda: w.game_object("late").drive((0.5, 0, 0), (0, 0, 0), ground=True))
    assert len(w.gliding.glides) == 1
    assert w.game_object("late").worldPosition.x == pytest.approx(0.5, abs=0.01)


def test_something_that_comes_onto_a_sleeper_wakes_it():
    w = world(ground(), rigid("sleeper", box(0.3, 0.3, 0.3), at=(0, 0, 0.15)))
    run(w, 2.0)
    assert (w.data.tree_asleep >= 0).all()
    # a wall that intersects it: the engine itself would let it sleep
    w.add([node("wall", box(1, 1, 1), at=(0.5, 0, 0.5))])
    run(w, 2.0)
    assert w.game_object("sleeper").worldPosition.x < -0.1


@pytest.mark.parametrize("name", ["block", "Ground"])
def test_a_name_that_is_taken_is_refused(name):
    w = world(ground(), rigid("block", box(1, 1, 1), at=(5, 5, 0.5)))
    before, roots = bits(w.get_state()), list(w.scene.roots)
    with pytest.raises(ValueError, match=f"there is already an object '{name}'"):
        w.add([rigid("new", box(1, 1, 1), at=(0, 0, 5)), rigid(name, box(1, 1, 1), at=(0, 0, 9))])
    assert w.scene.roots == roots
    assert bits(w.get_state()) == before


def test_a_shape_that_the_engine_refuses_changes_nothing():
    w = world(ground(), rigid("block", box(1, 1, 1), at=(5, 5, 0.5)))
    before, roots = bits(w.get_state()), list(w.scene.roots)
    with pytest.raises(ValueError, match="size"):
        w.add([rigid("flat", box(1, 1, -1), at=(0, 0, 5))])
    assert w.scene.roots == roots
    assert bits(w.get_state()) == before
    run(w, 0.1)


# removing -----------------------------------------------------------------------------------------


def test_what_rested_on_something_that_goes_falls():
    table = node("table", box(1, 1, 0.5), at=(0, 0, 0.25))
    w = world(ground(), table, rigid("cup", box(0.1, 0.1, 0.1), at=(0, 0, 0.55)))
    run(w, 2.0)
    assert (w.data.tree_asleep >= 0).all()
    w.remove([w.game_object("table")])
    run(w, 1.0)
    assert w.game_object("cup").worldPosition.z == pytest.approx(0.05, abs=0.001)


def test_what_a_removed_object_held_is_let_go_and_collides_again():
    w = make_busy()
    ticks(w, 30)
    assert w.game_object("held").worldPosition.z == pytest.approx(1.0, abs=0.01)
    w.remove([w.game_object("glider")])
    assert w.game_object("held").parent is None
    run(w, 2.0)
    assert w.game_object("held").worldPosition.z == pytest.approx(0.05, abs=0.001)


def test_what_was_held_can_go():
    w = make_busy()
    ticks(w, 30)
    w.remove([w.game_object("held")])
    ticks(w, 30)
    assert "held" not in w.objects_by_name


def test_a_floor_that_goes_lets_those_fall_that_glided_on_it():
    body = robot()
    w = world(node("Floor", box(10, 10, 1), at=(0, 0, -0.5)), body, robots=[body])
    run(w, 0.5, lambda: w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0), ground=True))
    assert w.gliding.glides
    w.remove([w.game_object("Floor")])
    run(w, 1.0, lambda: w.game_object("robot").drive((0.5, 0, 0), (0, 0, 0), ground=True))
    assert w.game_object("robot").worldPosition.z < -3.0


@pytest.mark.parametrize(
    "use",
    [
        lambda o: o.worldPosition,
        lambda o: setattr(o, "worldPosition", (0, 0, 0)),
        lambda o: o.velocity(),
        lambda o: o.applyForce((1, 0, 0)),
        lambda o: o.drive((1, 0, 0), (0, 0, 0)),
        lambda o: o.parent,
        lambda o: o.mass,
        lambda o: o.suspendDynamics(),
        lambda o: o.wheels(),
    ],
)
def test_a_removed_object_says_so(use):
    w = make_busy()
    ball = w.game_object("ball")
    assert not ball.invalid
    w.remove([ball])
    assert ball.invalid
    with pytest.raises(RemovedError, match="'ball' has been removed"):
        use(ball)
    assert ball.name == "ball"


def test_a_part_of_a_body_goes_with_its_declarations():
    body = robot("robot")
    eye = Node("eye", location=[0.2, 0.0, 0.3])
    eye.shapes = [sphere(0.05)]
    body.attach(eye)
    made = scene(ground(), body, robots=[body])
    made.components.append(ComponentDeclaration(eye, "sensor", "x.Y", body))
    w = World(made)
    w.remove([w.game_object("eye")])
    assert [c.node.name for c in made.components] == ["robot"]
    assert "eye" not in [child.name for child in w.game_object("robot").childrenRecursive]
    run(w, 0.2)


# replacing ----------------------------------------------------------------------------------------


def test_a_moving_body_that_is_replaced_stays_where_it_is():
    w = make_busy()
    ticks(w, 40)
    ball = w.game_object("ball")
    pose, velocity = ball.world_pose(), ball.velocity()
    new = rigid("ball", box(0.4, 0.4, 0.4), at=(0, 0, 0), mass=2.0)
    assert w.replace(ball.node, new) is ball
    assert (ball.world_pose(), ball.velocity()) == (pose, velocity)
    assert ball.node is new
    assert ball.mass == 2.0
    run(w, 2.0)
    assert ball.worldPosition.z == pytest.approx(0.2, abs=0.001)


def test_what_stands_still_comes_to_where_the_new_node_has_it():
    w = make_busy()
    bundle = w.rays.bundle(w.game_object("spirit"), [(0, 0, -1)], 30.0)
    wall = w.game_object("wall")
    w.replace(wall.node, node("wall", box(2, 2, 2), at=(0, 0, 1)))
    assert wall.worldPosition.x == 0.0
    w.rays.cast([bundle])
    assert bundle.distances[0] == pytest.approx(3.0)
    assert bundle.object_of(0) is wall


def test_a_robot_whose_body_is_replaced_drives_on():
    w = make_busy()
    ticks(w, 60)
    old = w.game_object("glider")
    x = old.worldPosition.x
    new = robot("glider", box(0.6, 0.5, 0.5), at=(0, 0, 0.25))
    w.replace(old.node, new)
    assert [c.node for c in w.scene.components if c.node.name == "glider"] == [new]
    ticks(w, 60)
    assert old.worldPosition.x == pytest.approx(x + 0.5, abs=0.05)
    assert w.game_object("held").worldPosition.z == pytest.approx(1.0, abs=0.01)


def test_a_replacement_that_lacks_what_carries_components_is_refused():
    body = robot("robot")
    body.attach(Node("robot.eye"))
    made = scene(ground(), body, robots=[body])
    made.components.append(ComponentDeclaration(body.children[0], "sensor", "x.Y", body))
    w = World(made)
    before = bits(w.get_state())
    with pytest.raises(ValueError, match=r"lacks robot\.eye"):
        w.replace(body, robot("robot"))
    assert bits(w.get_state()) == before
    assert [c.node for c in made.components] == [body, body.children[0]]


# observers ----------------------------------------------------------------------------------------


def test_rays_see_what_comes_and_no_longer_what_goes():
    w = world(ground(), Node("eye", location=[0.0, 0.0, 1.0]), rigid("far", box(1, 1, 1), at=(8, 0, 0.5)))
    bundle = w.rays.bundle(w.game_object("eye"), [(1, 0, 0), (0, 1, 0)], 30.0)
    upright = w.rays.bundle(w.game_object("eye"), [(1, 0, 0)], 30.0, upright=True)
    w.rays.cast([bundle, upright])
    w.add([node("wall", box(0.2, 4, 4), at=(3, 0, 1))])
    w.rays.cast([bundle, upright])
    assert bundle.distances[0] == pytest.approx(2.9)
    assert upright.distances[0] == pytest.approx(2.9)
    assert bundle.object_of(0).name == "wall"
    w.remove([w.game_object("wall")])
    assert bundle.object_of(0) is None
    w.remove([w.game_object("far")])
    w.rays.cast([bundle])
    assert np.isinf(bundle.distances).all()


def test_a_robot_that_comes_does_not_see_itself():
    w = world(ground(), Node("eye", location=[0.0, 0.0, 1.0]))
    w.rays.cast([w.rays.bundle(w.game_object("eye"), [(1, 0, 0)], 30.0)])
    cart, wheels = make_cart("cart", (0, 0, 0.15))
    w.add([cart], [wheels])
    bundle = w.rays.bundle(w.game_object("cart"), [(1, 0, 0), (0, 0, -1), (0, 1, 0)], 30.0)
    w.rays.cast([bundle])
    assert bundle.distances[0] == np.inf
    w.remove([w.game_object("eye")])
    w.rays.cast([bundle])
    assert bundle.distances[0] == np.inf
    assert bundle.object_of(1).name == "Ground"


def test_the_bundle_of_a_removed_sensor_is_left_alone():
    w = make_busy()
    bundle = w.rays.bundle(w.game_object("ball"), [(0, 0, -1)], 30.0)
    w.rays.cast([bundle])
    seen = bundle.distances.tolist()
    w.remove([w.game_object("ball")])
    ticks(w, 2)
    w.rays.cast([bundle])
    assert bundle.distances.tolist() == seen


def test_the_view_is_told():
    w = make_busy()
    layout, arrangement = w.layout, w.arrangement
    names = [made.name for made, _ in w.moving_nodes()]
    w.add([rigid("comer", box(0.2, 0.2, 0.2), at=(15, 15, 3))])
    assert w.layout != layout
    assert w.arrangement != arrangement
    assert sorted(made.name for made, _ in w.moving_nodes()) == sorted([*names, "comer"])
    shown = {made.name: row for (made, _), row in zip(w.moving_nodes(), w.poses(), strict=True)}
    assert shown["comer"][:3] == pytest.approx([15, 15, 3])
    assert shown["low"][:3] == pytest.approx([6, 6, 0.15], abs=1e-3)


def test_a_reset_keeps_who_came_and_puts_all_to_their_places():
    w = make_busy()
    w.add([rigid("comer", box(0.2, 0.2, 0.2), at=(15, 15, 3))])
    w.remove([w.game_object("low")])
    ticks(w, 60)
    w.reset()
    assert w.game_object("comer").worldPosition.z == pytest.approx(3.0)
    fresh = World(w.scene)
    for one in (w, fresh):
        ticks(one, 60)
    assert bits(w.get_state()) == bits(fresh.get_state())


# repetition -----------------------------------------------------------------------------------------


def come_and_go(w, times, chance):
    guests = []
    for number in range(times):
        if len(guests) > 5 or (guests and chance.random() < 0.4):
            w.remove([guests.pop(chance.randrange(len(guests)))])
        else:
            place = (chance.uniform(-12, 12), chance.uniform(-12, 12), 1.0)
            guests += w.add([rigid(f"guest{number}", box(0.2, 0.2, 0.2), at=place)])
        ticks(w, 1)
    w.remove(guests)


@pytest.mark.parametrize("times", [30, pytest.param(60, marks=pytest.mark.slow)])
def test_coming_and_going_leaves_memory_where_it_was(times):
    w, chance = make_busy(), random.Random(4)
    bundle = w.rays.bundle(w.game_object("spirit"), [(0, 0, -1)], 30.0)
    come_and_go(w, times // 3, chance)
    gc.collect()
    tracemalloc.start()
    try:
        come_and_go(w, times // 6, chance)
        grown = []
        for _ in range(2):
            w.rays.cast([bundle])
            gc.collect()
            first = tracemalloc.get_traced_memory()[0]
            come_and_go(w, times, chance)
            w.rays.cast([bundle])
            gc.collect()
            grown.append(tracemalloc.get_traced_memory()[0] - first)
        # one leaked object would take more than that in total; a dictionary of Python grows once
        assert min(grown) < 1_700 * times
    finally:
        tracemalloc.stop()
    assert set(BUSY) <= set(w.objects_by_name)


@pytest.mark.soak
def test_a_thousand_spawns_leave_memory_and_speed_where_they_were():
    resource = pytest.importorskip("resource")
    w, chance = make_busy(), random.Random(5)
    ticks(w, 200)

    def cost():
        begin = time.process_time()
        ticks(w, 600)
        return time.process_time() - begin

    come_and_go(w, 100, chance)
    before, memory = min(cost() for _ in range(3)), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    come_and_go(w, 1000, chance)
    assert min(cost() for _ in range(3)) < 1.3 * before
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - memory < 20_000
