"""A world in which everything sleeps needs no engine steps, and is bit-identical to a world with steps."""

import mujoco
import pytest
from worlds import bits, box, ground, node, rigid, robot, world

TICKS = 240


def make():
    body = robot(at=(3, 0, 0.25))
    boxes = [rigid(name, box(0.3, 0.3, 0.3), at=(0, 0, z)) for name, z in (("Box", 0.15), ("Upper", 0.45))]
    return world(ground(), node("Shelf", box(1, 1, 0.4), at=(-3, 0, 0.2)), *boxes, body, robots=[body])


@pytest.fixture
def steps(monkeypatch):
    """The number of engine steps."""
    count, step = [0], mujoco.mj_step

    def counted(*arguments):
        count[0] += 1
        step(*arguments)

    monkeypatch.setattr(mujoco, "mj_step", counted)
    return count


def asleep():
    w = make()
    for _ in range(TICKS):
        w.step()
    assert w.data.nv_awake == 0
    return w


def test_no_step_is_needed(steps):
    w = asleep()
    steps[0] = 0
    for _ in range(60):
        w.step()
    assert steps[0] == 0
    assert w.data.time == pytest.approx((TICKS + 60) / 60.0)


@pytest.mark.parametrize("at", [0, 1, 7])
def test_steps_would_change_nothing(at):
    w, stepped, restored = asleep(), asleep(), make()
    stepped._steps._all_sleep = lambda: False
    for _ in range(at):
        w.step()
        stepped.step()
    restored.set_state(w.get_state())
    for _ in range(50):
        for one in (w, stepped, restored):
            one.step()
        assert bits(w.get_state()) == bits(stepped.get_state()) == bits(restored.get_state())
        assert sorted(map(str, w.contacts())) == sorted(map(str, stepped.contacts()))


WAKING = {
    "a push": lambda w: w.game_object("Upper").applyForce((200, 0, 0)),
    "a velocity": lambda w: w.game_object("Upper").setLinearVelocity((0.5, 0, 0)),
    "another place": lambda w: setattr(w.game_object("Upper"), "worldPosition", (0, 0, 2.0)),
    "the lower one taken away": lambda w: setattr(w.game_object("Box"), "worldPosition", (1.5, 1.5, 0.15)),
    "a robot that drives": lambda w: w.game_object("robot").drive((-1.0, 0, 0), (0, 0, 0), ground=True),
}


@pytest.mark.parametrize("deed", WAKING)
def test_what_wakes_things_wakes_them(deed):
    w = asleep()
    for _ in range(20):
        w.step()
    slot = w.game_object("robot" if "drives" in deed else "Upper").slot
    before, farthest = w.positions.array[slot].copy(), 0.0
    for tick in range(40):
        if tick == 0 or "drives" in deed:
            WAKING[deed](w)
        w.step()
        farthest = max(farthest, abs(w.positions.array[slot] - before).max())
    assert farthest > 0.01
