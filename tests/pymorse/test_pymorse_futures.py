import concurrent.futures
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from scripted_simulation import ScriptedSimulation

from pymorse import Morse, MorseServiceFailed, MorseTimeoutError
from tests.kit.waiting import wait_until


@pytest.fixture
def simu(simulation: ScriptedSimulation) -> Iterator[Morse]:
    simulation.replies |= {"n two": "SUCCESS 2", "n three": "SUCCESS 3", "n never": None, "n bad": 'FAILED "broken"'}
    morse = Morse("127.0.0.1", simulation.port)
    yield morse
    morse.close(cancel_async_services=True)


def test_futures_compare_like_their_results(simu: Morse) -> None:
    two, three = simu.call("n", "two"), simu.call("n", "three")
    assert two == 2
    assert two != three
    assert two < three
    assert two <= 2
    assert three > two
    assert three >= 3
    assert repr(three) == str(three) == "3"
    assert len({two, three, simu.call("n", "two")}) == 3


def test_comparing_a_failed_call_raises(simu: Morse) -> None:
    with pytest.raises(MorseServiceFailed, match="broken"):
        assert simu.call("n", "bad") == 2


def test_callbacks_run_when_the_service_ends_and_may_call_services(simulation: ScriptedSimulation, simu: Morse) -> None:
    never = simu.call("n", "never")
    results: list[Any] = []
    never.add_done_callback(lambda future: results.append((future.result(), simu.rpc("n", "two"))))
    assert not results
    simulation.rpc.send(b"3 SUCCESS 1\n")
    wait_until(lambda: results == [(1, 2)])


def test_a_failing_callback_is_reported(
    simulation: ScriptedSimulation, simu: Morse, caplog: pytest.LogCaptureFixture
) -> None:
    simu.call("n", "two").add_done_callback(lambda _: 1 / 0)
    wait_until(lambda: "ZeroDivisionError" in caplog.text)


def test_futures_work_with_the_standard_library(simu: Morse) -> None:
    done, _ = concurrent.futures.wait([simu.call("n", "two"), simu.call("n", "three")], timeout=60)
    assert sorted(future.result() for future in done) == [2, 3]


def test_more_calls_than_worker_threads_run_at_the_same_time(simulation: ScriptedSimulation, simu: Morse) -> None:
    calls = [simu.call("n", "never") for _ in range(50)]
    wait_until(lambda: len(simulation.rpc.lines) == 53)
    simulation.rpc.send(b"".join(b"%d SUCCESS %d\n" % (n + 3, n + 1) for n in reversed(range(50))))
    assert [call.result(60) for call in calls] == list(range(1, 51))


def test_waiting_for_an_answer_can_be_limited(simu: Morse) -> None:
    with pytest.raises(MorseTimeoutError, match=r"n.never \(0.02 s\)") as caught:
        simu.rpc_t(0.02, "n", "never")
    assert isinstance(caught.value, RuntimeError)
    assert isinstance(caught.value, TimeoutError)
    closing = threading.Thread(target=simu.close)
    closing.start()
    closing.join(60)
    assert not closing.is_alive(), "nobody waits for that answer any more"


def test_the_exception_can_be_asked_for(simu: Morse) -> None:
    assert simu.call("n", "two").exception(60) is None
    assert isinstance(simu.call("n", "bad").exception(60), MorseServiceFailed)
    with pytest.raises(TimeoutError):
        simu.call("n", "never").exception(0.01)


def test_calls_from_many_threads_get_their_own_answers(simulation: ScriptedSimulation, simu: Morse) -> None:
    simulation.replies["n echo"] = lambda _, arguments: f"SUCCESS {arguments}"
    wrong: list[Any] = []

    def call(first: int) -> None:
        wrong.extend(n for n in range(first, first + 50) if simu.rpc("n", "echo", n) != [n])

    threads = [threading.Thread(target=call, args=(1000 * i,)) for i in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(60)
    assert not wrong
    assert not any(thread.is_alive() for thread in threads)
    assert len(simulation.rpc.lines) == 3 + 400


def test_an_answer_that_comes_after_others_were_waited_for_is_noticed(
    simulation: ScriptedSimulation, simu: Morse
) -> None:
    never = simu.call("n", "never")
    ended: list[Any] = []
    never.add_done_callback(lambda future: ended.append(future.result()))
    for _ in range(20):
        assert simu.rpc("n", "two") == 2
    simulation.rpc.send(b"3 SUCCESS 7\n")
    wait_until(lambda: ended == [7])


def test_closing_frees_a_thread_that_waits(simu: Morse) -> None:
    raised: list[BaseException] = []

    def wait() -> None:
        try:
            simu.rpc("n", "never")
        except Exception as error:
            raised.append(error)

    waiting = [threading.Thread(target=wait) for _ in range(3)]
    for thread in waiting:
        thread.start()
    wait_until(lambda: len(simu._services.pending()) == 3)
    simu.close(cancel_async_services=True)
    for thread in waiting:
        thread.join(60)
    assert [type(error) for error in raised] == [ConnectionError] * 3


def test_a_service_is_cancelled_by_its_future_or_its_number(simulation: ScriptedSimulation, simu: Morse) -> None:
    never = simu.call("n", "never")
    number = never.request
    cancel = f"{number} cancel\n".encode()
    for count, given in enumerate((never, number, str(number)), start=1):
        simu.cancel(given)
        wait_until(lambda count=count: simulation.rpc.lines.count(cancel) == count)
    for wrong in ("never", None, 1.5):
        with pytest.raises(TypeError, match="takes the future of a service, or its number"):
            simu.cancel(wrong)  # type: ignore[arg-type]


def test_an_argument_by_keyword_is_refused_with_the_name_of_the_service(simu: Morse) -> None:
    with pytest.raises(TypeError, match=r"robot1\.motion\.goto\(\) got an unexpected keyword argument 'x'"):
        simu.robot1.motion.goto(x=1)
