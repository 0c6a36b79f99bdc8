"""One page drives; its keys are released when it disconnects."""

from morse.viewer.page import DEAD_MAN, ControlLock

UP, LEFT = frozenset({"ArrowUp"}), frozenset({"ArrowLeft"})


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def seat_of(*pages: int) -> tuple[ControlLock, Clock]:
    clock = Clock()
    seat = ControlLock(clock)
    for page in pages:
        seat.enter(page)
    return seat, clock


def test_the_first_to_come_drives() -> None:
    seat, _ = seat_of(1, 2)
    seat.hold(2, LEFT)
    assert seat.held_keys() == frozenset()
    seat.hold(1, UP)
    assert seat.held_keys() == UP
    assert seat.driver == 1


def test_chords_and_releases() -> None:
    seat, _ = seat_of(1)
    seat.hold(1, UP | LEFT)
    assert seat.held_keys() == UP | LEFT
    seat.hold(1, LEFT)
    assert seat.held_keys() == LEFT
    seat.hold(1, frozenset())
    assert seat.held_keys() == frozenset()


def test_keys_are_released_when_the_heartbeat_stops() -> None:
    seat, clock = seat_of(1)
    seat.hold(1, UP)
    for _ in range(10):
        clock.now += DEAD_MAN * 0.9
        seat.hear(1)
        assert seat.held_keys() == UP
    clock.now += DEAD_MAN * 1.01
    assert seat.held_keys() == frozenset()


def test_keys_dropped_by_a_silence_do_not_come_back_by_themselves() -> None:
    seat, clock = seat_of(1)
    seat.hold(1, UP)
    clock.now += DEAD_MAN * 1.01
    seat.hear(1)
    assert seat.held_keys() == frozenset()
    seat.hold(1, UP)
    assert seat.held_keys() == UP


def test_the_gamepad_is_released_like_the_keys() -> None:
    seat, clock = seat_of(1)
    seat.steer(1, (0.5, -1.0), (True,))
    assert seat.gamepad() == ((0.5, -1.0), (True,))
    clock.now += DEAD_MAN * 1.01
    assert seat.gamepad() == ((), ())
    seat.hear(1)
    assert seat.gamepad() == ((), ())


def test_a_tap_between_two_ticks_is_held_for_one() -> None:
    seat, _ = seat_of(1)
    seat.begin_tick()
    seat.hold(1, UP)
    seat.hold(1, frozenset())
    seat.begin_tick()
    assert seat.held_keys() == UP
    seat.begin_tick()
    assert seat.held_keys() == frozenset()


def test_asked_and_handed_over() -> None:
    seat, _ = seat_of(1, 2, 3)
    seat.hold(1, UP)
    seat.ask(2)
    assert (seat.driver, seat.message(3).asking) == (1, [2])
    assert not seat.hand_over(2, 2, [1, 2, 3])
    assert not seat.hand_over(1, 9, [1, 2, 3])
    assert seat.hand_over(1, 2, [1, 2, 3])
    assert (seat.driver, seat.message(3).asking) == (2, [])
    assert seat.held_keys() == frozenset()


def test_declined() -> None:
    seat, _ = seat_of(1, 2)
    seat.ask(2)
    seat.keep(2)
    assert seat.message(2).asking == [2]
    seat.keep(1)
    assert (seat.driver, seat.message(2).asking) == (1, [])


def test_a_driver_that_sleeps_gives_way_at_once() -> None:
    seat, clock = seat_of(1, 2)
    clock.now += DEAD_MAN * 1.01
    seat.ask(2)
    assert seat.driver == 2


def test_a_driver_that_leaves_makes_room_for_who_asked() -> None:
    seat, _ = seat_of(1, 2, 3)
    seat.ask(3)
    seat.leave(1)
    assert seat.driver == 3
    seat.leave(3)
    assert seat.driver is None
    seat.enter(4)
    assert seat.driver == 4


def test_the_only_page_that_is_left_takes_the_wheel_by_itself() -> None:
    seat, _ = seat_of(1, 2, 3)
    seat.leave(1, [2, 3])
    assert seat.driver is None  # no page has requested control, and there are two candidates
    seat.leave(3, [2])
    assert seat.driver == 2
    seat.leave(2, [])
    assert seat.driver is None
