"""Connections that cannot be opened, break, or are closed."""

import signal
import socket
import subprocess
import sys
import textwrap
import threading
from pathlib import Path

import pytest
from scripted_simulation import Endpoint, ScriptedSimulation

from pymorse import Morse, MorseFuture, MorseServicePreempted
from pymorse import pymorse as module
from tests.kit.programs import free_port
from tests.kit.waiting import wait_until

SOURCE = Path(__file__).parents[2] / "src"


@pytest.fixture(name="free_port")
def _free_port() -> int:
    return free_port()


def test_no_simulation(free_port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "PORTS", ())
    with pytest.raises(ConnectionRefusedError, match=rf"127.0.0.1:{free_port}.*'morse run"):
        Morse("127.0.0.1", free_port)


def test_a_simulation_on_another_port_is_named(free_port: int, monkeypatch: pytest.MonkeyPatch) -> None:
    other = Endpoint()
    monkeypatch.setattr(module, "PORTS", (free_port, other.port))
    with pytest.raises(ConnectionRefusedError, match=rf"try Morse\('127.0.0.1', {other.port}\)"):
        Morse("127.0.0.1", free_port)
    other.close()


def test_no_such_host() -> None:
    with pytest.raises(ConnectionError, match=r"the host 'morse.invalid' does not exist"):
        Morse("morse.invalid")


@pytest.mark.parametrize(
    "reply", ["SUCCESS", "SUCCESS []", 'SUCCESS {"robots": [{}]}', "SUCCESS 3", 'SUCCESS {"robots": 3}']
)
def test_something_that_is_no_simulation(reply: str) -> None:
    with (
        ScriptedSimulation({}, {"simulation details": reply}) as scripted,
        pytest.raises(ConnectionError, match="the format of MORSE"),
    ):
        Morse("127.0.0.1", scripted.port)


def test_a_server_that_hangs_up() -> None:
    server = Endpoint(lambda connection, _: connection.shutdown(socket.SHUT_RDWR))
    with pytest.raises(ConnectionError, match=r"before it answered simulation.details"):
        Morse("127.0.0.1", server.port)
    server.close()


def test_calls_end_when_the_simulation_does(simulation: ScriptedSimulation) -> None:
    simulation.replies["robot1.motion goto"] = None
    with Morse("127.0.0.1", simulation.port) as simu:
        going = simu.robot1.motion.goto(1)
        wait_until(lambda: len(simulation.rpc.lines) == 4)
        simulation.rpc.drop()
        with pytest.raises(ConnectionError, match=r"before it answered robot1.motion.goto"):
            going.result(60)
        assert not simu.is_up()
        with pytest.raises(ConnectionError, match="still running"):
            simu.rpc("simulation", "details")


def test_the_end_of_a_stream_names_its_component(simulation: ScriptedSimulation) -> None:
    with Morse("127.0.0.1", simulation.port) as simu:
        pose = simu.robot1.pose
        assert pose.last() is None
        wait_until(lambda: simulation.streams["robot1.pose"].connections)
        simulation.streams["robot1.pose"].drop()
        with pytest.raises(ConnectionError, match=r"robot1\.pose \(127\.0\.0\.1:\d+\) closed the stream"):
            pose.get()


def test_quitting_needs_no_answer(simulation: ScriptedSimulation) -> None:
    def hang_up(*_: str) -> None:
        simulation.rpc.drop()

    simulation.replies["simulation quit"] = hang_up
    Morse("127.0.0.1", simulation.port).quit()
    wait_until(lambda: simulation.rpc.lines[-1] == b"3 simulation quit []\n")


def test_closing_waits_for_services(simulation: ScriptedSimulation) -> None:
    simulation.replies["robot1.motion goto"] = None
    with Morse("127.0.0.1", simulation.port) as simu:
        going = simu.robot1.motion.goto(1)
        threading.Timer(0.1, simulation.rpc.send, [b'3 SUCCESS "Arrived"\n']).start()
    assert going.result(0) == "Arrived"


def test_an_error_in_the_script_cancels_services(
    simulation: ScriptedSimulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "_PARTING_TIMEOUT", 60.0)
    simulation.replies |= {"robot1.motion goto": None, "cancel": "PREEMPTED"}
    started: list[MorseFuture] = []

    def fail() -> None:
        with Morse("127.0.0.1", simulation.port) as simu:
            started.append(simu.robot1.motion.goto(1))
            _ = 1 / 0

    with pytest.raises(ZeroDivisionError):
        fail()
    assert b"3 cancel\n" in simulation.rpc.lines
    assert isinstance(started[0].exception(0), MorseServicePreempted)


def test_closing_is_final_and_may_be_repeated(simulation: ScriptedSimulation) -> None:
    simu = Morse("127.0.0.1", simulation.port)
    motion = simu.robot1.motion
    simu.close()
    simu.close()
    with pytest.raises(ConnectionError, match=r"create a new Morse\(\)"):
        motion.publish({})
    with pytest.raises(ConnectionError, match=r"create a new Morse\(\)"):
        simu.time()


def test_a_component_can_be_closed_and_used_again(simulation: ScriptedSimulation) -> None:
    with Morse("127.0.0.1", simulation.port) as simu:
        simu.robot1.motion.publish({"v": 1})
        # each connection has a thread there that reads: one may be faster than that of the connection before
        wait_until(lambda: simulation.streams["robot1.motion"].lines == [b'{"v": 1}\n'])
        simu.robot1.motion.close()
        simu.robot1.motion.publish({"v": 2})
    wait_until(lambda: simulation.streams["robot1.motion"].lines == [b'{"v": 1}\n', b'{"v": 2}\n'])
    assert simulation.streams["robot1.motion"].accepted == 2


def test_what_was_published_last_arrives(simulation: ScriptedSimulation) -> None:
    for round_ in range(20):
        with Morse("127.0.0.1", simulation.port) as simu:
            for n in range(50):
                simu.robot1.motion.publish({"round": round_, "n": n})
        wait_until(lambda: len(simulation.streams["robot1.motion"].lines) == 50)
        assert simulation.streams["robot1.motion"].lines[-1] == b'{"round": %d, "n": 49}\n' % round_
        simulation.streams["robot1.motion"].lines.clear()


def test_a_large_message_arrives_before_closing(
    simulation: ScriptedSimulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "TIMEOUT", 60.0)
    with Morse("127.0.0.1", simulation.port) as simu:
        simu.robot1.motion.publish({"points": [0.5] * 2_000_000})
    (line,) = wait_until(lambda: simulation.streams["robot1.motion"].lines)
    assert len(line) == len('{"points": []}\n') + 5 * 2_000_000 - 2


def script(simulation: ScriptedSimulation, body: str) -> subprocess.Popen[str]:
    text = textwrap.dedent(body).replace("PORT", str(simulation.port))
    # in background jobs of a shell, tests ignore Ctrl+C, and so would their children
    text = f"import signal; signal.signal(signal.SIGINT, signal.default_int_handler)\n{text}"
    return subprocess.Popen(
        [sys.executable, "-W", "error", "-c", text],
        env={"PYTHONPATH": str(SOURCE), "PYTHONDEVMODE": "1"},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def asleep(process: subprocess.Popen[str]) -> bool:
    """Whether the main thread of a script sleeps: signals that come before that do not interrupt a read."""

    def look() -> tuple[str, str]:
        status = Path(f"/proc/{process.pid}/status").read_text()
        fields = dict(line.split(":", 1) for line in status.splitlines())
        return fields["State"].split()[0], fields["voluntary_ctxt_switches"]

    # a thread that waits for the lock of the interpreter wakes up again at once
    looks = {look() for _ in range(100)}
    return len(looks) == 1 and looks.pop()[0] == "S"


def interrupt(process: subprocess.Popen[str], *, sleeps: bool = True) -> tuple[str, str]:
    """Press Ctrl+C when the script waits; what the script has printed."""
    assert process.stdout is not None
    try:
        assert process.stdout.readline() == "waiting\n"
        if sleeps:
            wait_until(lambda: asleep(process))
        process.send_signal(signal.SIGINT)
        process.wait(60)  # `communicate` would close its standard input, which ends `input()`, too
    except BaseException:
        process.kill()
        raise
    return process.communicate(timeout=60)


def test_a_script_that_forgets_to_close_still_sends_and_ends(simulation: ScriptedSimulation) -> None:
    simulation.replies["robot1.motion goto"] = None
    process = script(
        simulation,
        """
        from pymorse import Morse
        simu = Morse("127.0.0.1", PORT)
        simu.robot1.pose.subscribe(print)
        simu.robot1.motion.goto(1)
        simu.robot1.motion.publish({"v": 1.0})
        """,
    )
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out, err) == (0, "", "")
    wait_until(lambda: simulation.streams["robot1.motion"].lines == [b'{"v": 1.0}\n'])
    wait_until(lambda: simulation.rpc.lines[-1] == b"3 cancel\n")


@pytest.mark.parametrize(
    "waiting",
    [
        "input()",
        "simu.robot1.pose.get()",
        "simu.rpc('robot1.motion', 'goto')",
        "simu.robot1.motion.goto().result()",
        "simu.spin()",
    ],
)
def test_ctrl_c_ends_a_script_whatever_it_waits_for(simulation: ScriptedSimulation, waiting: str) -> None:
    simulation.replies["robot1.motion goto"] = None
    process = script(
        simulation,
        f"""
        from pymorse import Morse
        try:
            with Morse("127.0.0.1", PORT) as simu:
                simu.robot1.motion.publish({{"v": 1.0}})
                print("waiting", flush=True)
                {waiting}
        except KeyboardInterrupt:
            print("interrupted")
        """,
    )
    out, err = interrupt(process)
    assert err == ""
    assert process.returncode == 0
    assert out in ("interrupted\n", "" if waiting == "simu.spin()" else "interrupted\n")
    wait_until(lambda: simulation.streams["robot1.motion"].lines == [b'{"v": 1.0}\n'])


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
@pytest.mark.parametrize("waiting", ["simu.robot1.pose.get()", "while True: pass", "simu.rpc('robot1.motion', 'goto')"])
def test_ctrl_c_ends_a_script_without_a_traceback(simulation: ScriptedSimulation, waiting: str) -> None:
    simulation.replies["robot1.motion goto"] = None
    process = script(
        simulation,
        f"""
        from pymorse import Morse
        with Morse("127.0.0.1", PORT) as simu:
            print("waiting", flush=True)
            {waiting}
        print("not reached")
        """,
    )
    out, err = interrupt(process, sleeps="pass" not in waiting)
    assert (out, err) == ("", "")
    assert process.returncode != 0, "it did not end by itself"


def test_other_errors_keep_their_traceback(simulation: ScriptedSimulation) -> None:
    process = script(
        simulation,
        """
        from pymorse import Morse
        try:
            with Morse("127.0.0.1", PORT):
                raise KeyboardInterrupt
        except KeyboardInterrupt:
            pass
        raise KeyboardInterrupt("of somebody else")
        """,
    )
    _, err = process.communicate(timeout=60)
    assert "of somebody else" in err


@pytest.mark.parametrize("port", [-1, 0, 65536, "x"])
def test_port_that_cannot_exist_is_named(port):
    with pytest.raises(ConnectionError, match=f"there is no port {port!r}: expected a number from 1 to 65535"):
        Morse("127.0.0.1", port)
