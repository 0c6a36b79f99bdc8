"""Row k has the data of its simulation alone, bit for bit, whatever the other rows do."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from many_scenes import arena, crowded_arena

import morse
from effort import examples

#: component, fields: what is compared in each step
DATA = [
    ("robot.gps", ("x", "y", "z")), ("robot.pose", ("x", "y", "yaw")), ("robot.laser", ("range_list",)),
    ("robot.camera", ("image",)), ("robot.depth", ("image",)), ("robot.imu", ("linear_acceleration",)),
    ("robot.odometry", ("x", "y", "vx", "wz")), ("robot.accelerometer", ("velocity",)),
    ("robot.bumper", ("collision",)), ("second.pose", ("x", "y")), ("robot.clock", ("timestamp",)),
]  # fmt: skip


def values_of(data, fields):
    value = (
        np.concatenate([np.ravel(data[name]) for name in fields]) if len(fields) > 1 else np.asarray(data[fields[0]])
    )
    return value[..., :3] if value.ndim == 3 else value


def alone(scene, seed, acts, ticks, measure):
    """What a simulation alone measures; each act is a command of both robots, or an episode that begins."""
    with morse.load(scene, seed=seed) as sim:
        contacts = sim.robot.contacts()
        for act in acts:
            if act[0] == "restart":
                sim.restart(act[1])
            elif act[0] == "place":
                sim.place("robot", act[1])
            else:
                sim.robot.motion.publish({"v": act[0], "w": act[1]})
                sim.second.motion.publish({"x": act[2], "y": 0.0, "w": 0.0})
            sim.step(ticks, measure=measure)
            data = {key: values_of(sim[key[0].split(".")[0]][key[0].split(".")[1]].component.local_data, key[1])
                    for key in DATA}  # fmt: skip
            yield data, contacts.touched, contacts.impulse, sim.state_hash()


speeds = st.floats(-3.0, 3.0).map(lambda speed: round(speed, 2))
acts = st.one_of(
    st.tuples(speeds, speeds, speeds),
    st.tuples(st.just("restart"), st.integers(0, 9)),
    st.tuples(st.just("place"), st.sampled_from([(0.0, 1.0, 0.5), (1.0, -1.0, 3.0)])),
)


@settings(max_examples=examples(20))
@given(
    rows=st.lists(st.lists(acts, min_size=4, max_size=4), min_size=3, max_size=3),
    ticks=st.sampled_from([1, 6, 11]),
    measure=st.booleans(),
)
def test_each_row_is_as_alone(rows, ticks, measure):
    with morse.batch(crowded_arena, len(rows), seed=3) as many:
        drive, push = many.command("robot.motion", "v", "w"), many.command("second.motion", "x", "y", "w")
        hit = many.contacts("robot")
        columns = {key: many.read(key[0], *key[1]) for key in DATA}
        references = [alone(crowded_arena, 3 + row, rows[row], ticks, measure) for row in range(len(rows))]
        for number in range(len(rows[0])):
            for row, act in enumerate(script[number] for script in rows):
                if act[0] == "restart":
                    many.restart(row, [act[1]])
                elif act[0] == "place":
                    many.place(row, "robot", act[1])
                else:
                    drive[row], push[row] = act[:2], (act[2], 0.0, 0.0)
            many.step(ticks, measure=measure)
            for row, reference in enumerate(references):
                data, touched, impulse, state = next(reference)
                for key, value in data.items():
                    if value.size:
                        np.testing.assert_array_equal(columns[key][row], value, err_msg=f"{key} in row {row}")
                assert (hit[row], hit.impulse[row]) == (touched, impulse)
                assert many[row].state_hash() == state
        for reference in references:
            reference.close()


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
