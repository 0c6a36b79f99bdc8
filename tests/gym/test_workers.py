"""Processes of vectors: the same bits with any number of them; what interrupts the program interrupts no exchange."""

import os
import signal
import threading
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from gym_tasks import DriveAbout, Picture
from gymnasium.error import ClosedEnvironmentError, ResetNeeded
from gymnasium.vector import AutoresetMode

import morse.gym
from morse.system.workers import Worker, WorkerError

ROWS = 5


def equal(one: Any, other: Any) -> bool:
    """Whether results have the same types and bits."""
    if isinstance(one, dict):
        return list(one) == list(other) and all(equal(one[name], other[name]) for name in one)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(equal, one, other))
    if isinstance(one, np.ndarray) and one.dtype == object:
        return one.shape == other.shape and all(map(equal, one.ravel().tolist(), other.ravel().tolist()))
    if isinstance(one, np.ndarray):
        return bool(one.dtype == other.dtype and np.array_equal(one, other))
    return bool(one == other)


class Every:
    """Vectors with several numbers of workers, which give the same."""

    def __init__(self, **options: Any) -> None:
        task, numbers = options.pop("task", DriveAbout), options.pop("numbers", (0, 1, 2, 5))
        self.vectors = [morse.gym.vector(task, ROWS, workers=number, **options) for number in numbers]

    def call(self, name: str, *arguments: Any, **options: Any) -> Any:
        """Call a method of all, and return what it gives."""
        first, *others = [getattr(env, name)(*arguments, **options) for env in self.vectors]
        for other in others:
            assert equal(first, other), name
        return first

    def close(self) -> None:
        """End all."""
        for env in self.vectors:
            env.close()


@pytest.fixture
def every(request: pytest.FixtureRequest) -> Iterator[Every]:
    vectors = Every(**getattr(request, "param", {}))
    yield vectors
    vectors.close()


@pytest.mark.parametrize(
    ("every", "first"),
    [
        ({"autoreset_mode": "SameStep"}, {}),
        ({"autoreset_mode": "NextStep"}, {"seed": 3}),
        ({"autoreset_mode": "Disabled"}, {"options": {"reset_mask": np.arange(ROWS) == 1}}),
    ],
    indirect=["every"],
    ids=["same step, no seed", "next step, a seed", "disabled, a mask"],
)
def test_any_number_of_workers_gives_the_same_bits(every: Every, first: dict[str, Any]) -> None:
    observations, infos = every.call("reset", **first)
    assert len({row.tobytes() for row in observations}) == ROWS  # no row does what another one does
    assert infos["_robot.mass"].all()
    rng, ended = np.random.default_rng(0), np.zeros(ROWS, bool)
    for number in range(25):
        if number == 12:
            every.call("reset")
            ended[:] = False
        if ended.any() and every.vectors[0].metadata["autoreset_mode"] is AutoresetMode.DISABLED:
            for env in every.vectors:
                with pytest.raises(ResetNeeded, match=rf"the rows \[{np.flatnonzero(ended)[0]}"):
                    env.step(np.zeros((ROWS, 2)))
            every.call("reset", options={"reset_mask": ended})
        _, _, terminated, late, infos = every.call("step", rng.uniform(-1.0, 1.0, (ROWS, 2)))
        ended = terminated | late
        if "final_info" in infos:
            assert (infos["final_info"]["_x"] == ended).all()
    every.call("reset", seed=[5, 4, 3, 2, 1], options={"reset_mask": np.arange(ROWS) > 2})
    every.call("step", np.ones((ROWS, 2)))


@pytest.mark.parametrize(
    "every", [{"task": Picture, "numbers": (0, 2), "render_mode": "rgb_array"}], indirect=True, ids=["camera"]
)
def test_pictures_of_any_number_of_workers_are_the_same(every: Every) -> None:
    every.call("reset")
    assert len(every.call("render")) == ROWS


@pytest.mark.parametrize("workers", [0, 2])
def test_a_mask_of_another_form_is_named(workers: int) -> None:
    env = morse.gym.vector(DriveAbout, ROWS, workers=workers)
    for mask in ([True], np.ones(ROWS), "all", np.ones((ROWS, 1), bool)):
        with pytest.raises(ValueError, match="reset_mask is an array of 5 booleans, not "):
            env.reset(options={"reset_mask": mask})
    env.close()


class Alarm(Exception):
    """Raised by a handler of a signal."""


@pytest.mark.parametrize("kind", [Alarm, KeyboardInterrupt])
def test_what_interrupts_a_call_leaves_all_rows_in_the_same_step(kind: type[BaseException]) -> None:
    """At any moment: the step is done in all rows or in none, and the next answer belongs to the next question."""

    def ring(*_: object) -> None:
        raise kind

    env, alone = (morse.gym.vector(DriveAbout, 4, workers=workers) for workers in (2, 0))
    before = signal.signal(signal.SIGALRM, ring)
    actions, interruptions = np.tile([0.7, 0.4], (4, 1)), 0
    try:
        env.reset(seed=1)
        alone.reset(seed=1)
        rng, usual, limit = np.random.default_rng(0), 0.01, time.monotonic() + 60.0
        while interruptions < 30 and time.monotonic() < limit:
            begin = time.monotonic()
            try:
                signal.setitimer(signal.ITIMER_REAL, rng.uniform(1e-4, 1.2 * usual))
                env.step(actions)
                signal.setitimer(signal.ITIMER_REAL, 0.0)
            except kind:
                interruptions += 1
                after = env.step(actions)
                assert equal(after, alone.step(actions)) or equal(after, alone.step(actions))
            else:
                usual = time.monotonic() - begin
                alone.step(actions)
        while interruptions < 35 and time.monotonic() < limit:
            try:
                signal.setitimer(signal.ITIMER_REAL, rng.uniform(1e-4, usual))
                env.reset()
                signal.setitimer(signal.ITIMER_REAL, 0.0)
            except kind:
                interruptions += 1
        assert equal(env.reset(seed=9), alone.reset(seed=9))
        assert equal(env.step(actions), alone.step(actions))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
        env.close()
        alone.close()
    assert interruptions == 35


def test_ctrl_c_in_a_terminal_ends_no_worker() -> None:
    env = morse.gym.vector(DriveAbout, 2, workers=2)
    env.reset(seed=1)
    for worker in env._rows.parts.workers.values():
        os.kill(worker.pid, signal.SIGINT)
    for _ in range(10):
        env.step(np.zeros((2, 2)))
    env.close()


def step_often(env: Any) -> None:
    """Step until an error."""
    for _ in range(1000):
        env.step(np.zeros((env.num_envs, 2)))


def test_a_worker_that_is_killed_at_any_moment_is_named_and_replaced() -> None:
    env, alone = (morse.gym.vector(DriveAbout, 4, workers=workers) for workers in (2, 0))
    starts = [env.reset()[0][2:]]
    for moment in (0.0, 0.001, 0.003, 0.006):
        timer = threading.Timer(moment, os.kill, (env._rows.parts.workers[1].pid, signal.SIGKILL))
        timer.start()
        with pytest.raises(RuntimeError, match="the process of the rows 2 to 3 has ended by SIGKILL"):
            step_often(env)
        timer.join()
        starts.append(env.reset()[0][2:])
        assert equal(env.reset(seed=6), alone.reset(seed=6))
        assert equal(env.step(np.ones((4, 2))), alone.step(np.ones((4, 2))))
    env.close()
    alone.close()
    # a process that is replaced does not begin with the same episodes again
    assert len({start.tobytes() for start in starts}) == len(starts)


class Stuck(DriveAbout):
    """A task whose second step never ends in one row."""

    def reward(self, before: Any, now: Any) -> Any:
        self.steps = getattr(self, "steps", 0) + 1
        while self.first_row and self.steps > 1:
            time.sleep(0.01)
        return super().reward(before, now)


def test_a_vector_with_a_worker_that_never_answers_is_closed_at_once() -> None:
    env = morse.gym.vector(Stuck, 2, workers=2)
    env.reset(seed=1)
    env.step(np.zeros((2, 2)))

    def ring(*_: object) -> None:
        raise Alarm

    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.5)
        with pytest.raises(Alarm):
            env.step(np.zeros((2, 2)))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    workers = list(env._rows.parts.workers.values())
    env.close()
    assert not any(worker.is_alive for worker in workers)
    with pytest.raises(ClosedEnvironmentError, match="make it again"):
        env.step(np.zeros((2, 2)))


class Talker:
    """A server that prints, and answers the first question twice, in the end for nobody."""

    def __init__(self) -> None:
        os.write(1, b"I print what I like\n")

    def answer(self, question: bytes) -> bytes:
        """Return the question, unless it is to end the process."""
        print("an answer?", question, flush=True)
        if question == b"die":
            os.kill(os.getpid(), signal.SIGKILL)
        return question

    def close(self) -> None:
        """Nothing."""


def test_late_answers_are_discarded_and_prints_are_none() -> None:
    worker = Worker.copy(Talker)
    worker.send(b"the first")  # whose answer nobody waits for
    worker.send(b"the second")
    assert worker.receive() == b"the second"
    worker.send(b"die")
    with pytest.raises(WorkerError, match="by SIGKILL"):
        worker.receive()
    worker.send(b"again")
    with pytest.raises(WorkerError):
        worker.receive()
    worker.close()
