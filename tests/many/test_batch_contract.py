"""Row k has the data of its simulation alone, bit for bit, whatever the other rows do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_scenes import arena, crowded_arena, fleet_arena

import morse
from tests.kit.effort import examples

#: scene: the robot that contacts, places and parameters are about; commands, with their least and largest values
SCENES = {
    crowded_arena: ("robot", {("robot.motion", "v", "w"): [(-3, 3), (-3, 3)], ("second.motion", "x"): [(-3, 3)]}),
    fleet_arena: (
        "wheels",
        {
            ("wheels.motion", "v", "w"): [(-2, 2), (-2, 2)],
            ("carrier.motion", "v", "w"): [(-2, 2), (-2, 2)],
            ("carrier.unit", "pan"): [(-1, 1)],
            ("carrier.arm", "kuka_2"): [(-1, 1)],
            ("drone.motion", "x", "z"): [(-2, 2), (1, 4)],
            ("other.motion", "theta_c"): [(-0.1, 0.1)],
            ("goer.motion", "x", "y"): [(-4, 4), (-4, 4)],
        },
    ),
}
PLACES = [(0.0, 1.0, 0.5), (1.0, -1.0, 3.0), (-1.4, 0.1, 0.0), (0.5, 0.5, 0.6, 0.3, 0.2, 1.0)]


class Alone:
    """One simulation, by its own interface."""

    def __init__(self, scene, seed):
        self.name, commands = SCENES[scene]
        self.sim, self.seed, self.state = morse.load(scene, seed=seed), seed, None
        self.contacts = self.sim[self.name].contacts()
        self.drives = [(part_of(self.sim, name), fields) for name, *fields in commands]

    def act(self, kind, value):
        sim = self.sim
        if kind == "drive":
            for (handle, fields), values in zip(self.drives, value, strict=True):
                handle.publish(dict(zip(fields, values, strict=True)))
        elif kind == "restart":
            sim.restart(value)
        elif kind == "place":
            sim[self.name].place(value)
        elif kind == "vary":
            sim[self.name].set_mass(value)
            sim[self.name].set_friction(value / 20.0)
        elif kind == "save":
            self.state = sim.save()
        elif kind == "restore" and self.state is not None:
            sim.restore(self.state)


def part_of(sim, name):
    robot, *parts = name.split(".")
    handle = sim[robot]
    for part in parts:
        handle = handle.parts[part]
    return handle


def acts_of(scene):
    """A strategy for what happens to a row before a step."""
    commands = [
        st.tuples(*(st.floats(low, high).map(lambda value: round(value, 2)) for low, high in bounds))
        for bounds in SCENES[scene][1].values()
    ]
    return st.one_of(
        st.tuples(st.just("drive"), st.tuples(*commands)),
        st.tuples(st.just("drive"), st.tuples(*commands)),
        st.tuples(st.just("restart"), st.integers(0, 9)),
        st.tuples(st.just("place"), st.sampled_from(PLACES)),
        st.tuples(st.just("vary"), st.floats(5.0, 20.0)),
        st.tuples(st.sampled_from(["save", "restore", "idle"]), st.none()),
    )


def act_on_row(many, row, kind, value, drives, states, name):
    if kind == "drive":
        for drive, values in zip(drives, value, strict=True):
            drive[row] = values if len(values) > 1 else values[0]
    elif kind == "restart":
        many.restart(row, [value])
    elif kind == "place":
        many.place(row, name, value)
    elif kind == "vary":
        many.vary(name, rows=row, mass=value, friction=value / 20.0)
    elif kind == "save":
        states[row] = many.save(row)
    elif kind == "restore" and row in states:
        many.restore(row, states[row])


def columns_of(many):
    """All fields of all components that have a column."""
    columns = {}
    for component, part in {**many[0].context.robots, **many[0].context.components}.items():
        for field in part.local_data:
            columns[component, field] = many.read(component, field)
    return columns


def assert_equal(present, value, what):
    if not isinstance(present, (np.ndarray, np.generic)):
        assert present == value or not np.size(value), what
    elif np.size(value):
        value = np.asarray(value)
        colours = value.dtype == np.uint8 and value.ndim == 3
        np.testing.assert_array_equal(present, value[..., :3] if colours else value, err_msg=what)


def check_rows(scene, scripts, ticks, measure):
    """Rows that do what each script says, compared with simulations alone that do the same."""
    name, commands = SCENES[scene]
    alone = [Alone(scene, 3 + row) for row in range(len(scripts))]
    with morse.batch(scene, len(scripts), seed=3) as many:
        drives, states = [many.command(*words) for words in commands], {}
        hit, columns = many.contacts(name), columns_of(many)
        for acts in zip(*scripts, strict=True):
            for row, (kind, value) in enumerate(acts):
                act_on_row(many, row, kind, value, drives, states, name)
                alone[row].act(kind, value)
            many.step(ticks, measure=measure)
            for row, other in enumerate(alone):
                other.sim.step(ticks, measure=measure)
                for (component, field), column in columns.items():
                    value = other.sim.context.component(component).local_data[field]
                    assert_equal(column[row], value, f"{field} of {component} in row {row}")
                assert (hit[row], hit.impulse[row]) == (other.contacts.touched, other.contacts.impulse)
                assert many[row].state_hash() == other.sim.state_hash()
    for other in alone:
        other.sim.close()


def scripts_of(scene):
    return st.lists(st.lists(acts_of(scene), min_size=4, max_size=4), min_size=3, max_size=3)


@settings(max_examples=examples(15))
@given(scripts=scripts_of(crowded_arena), ticks=st.sampled_from([1, 6, 11]), measure=st.booleans())
def test_each_row_is_as_alone(scripts, ticks, measure):
    check_rows(crowded_arena, scripts, ticks, measure)


@settings(max_examples=examples(4))
@given(scripts=scripts_of(fleet_arena), ticks=st.sampled_from([1, 6, 11]), measure=st.booleans())
def test_each_row_of_many_kinds_is_as_alone(scripts, ticks, measure):
    check_rows(fleet_arena, scripts, ticks, measure)


def test_equal_seeds_are_equal_rows_and_scenes_alternate():
    def other():
        arena()

    with morse.batch([arena, other], 4, seed=[5, 5, 5, 6]) as many:
        drive, pose = many.command("robot.motion", "v", "w"), many.read("robot.pose", "x", "y", "yaw")
        drive[:] = [1.0, 0.5]
        many.step(30, measure=True)
        assert (pose == pose[0]).all()
        hashes = [sim.state_hash() for sim in many]
    assert hashes[0] == hashes[2]
    assert hashes[3] != hashes[0]


def test_a_restored_row_continues_as_it_did():
    with morse.batch(arena, 2) as many:
        drive, scan = many.command("robot.motion", "v", "w"), many.read("robot.laser", "range_list")
        drive[:] = [1.0, 0.3]
        many.step(20)
        states = many.save()
        many.step(30, measure=True)
        first, hashes = scan.copy(), [sim.state_hash() for sim in many]
        many.restore([1, 0], states[::-1])
        many.step(30, measure=True)
        assert (scan == first).all()
        assert [sim.state_hash() for sim in many] == hashes


@pytest.mark.slow
def test_sixty_four_rows():
    with morse.batch(arena, 64) as many:
        drive, pose = many.command("robot.motion", "v", "w"), many.read("robot.pose", "x", "y", "yaw")
        rng = np.random.default_rng(1)
        actions = rng.uniform([0.0, -1.5], [1.5, 1.5], (20, 64, 2))
        for action in actions:
            drive[:] = action
            many.step(6, measure=True)
        for row in (0, 17, 63):
            with morse.load(arena, seed=row) as sim:
                for action in actions:
                    sim.robot.motion.publish({"v": action[row, 0], "w": action[row, 1]})
                    sim.step(6)
                assert [sim.robot.pose.data[name] for name in ("x", "y", "yaw")] == pose[row].tolist()
