"""What a tick enters on the way of a command from a socket to the wheel."""

import socket
import sys
from collections.abc import Callable
from contextlib import closing
from pathlib import Path
from types import FrameType

import morse
from morse.builder import Environment, Morsy, MotionVW, Pose
from morse.simulation.simulation import Simulation

#: files of the tick of a command, without the network thread; more of them make the way harder to follow
_MOST = 40
_ROOT = Path(morse.__file__).parent


def _robot_on_a_socket() -> None:
    robot = Morsy("robot")
    robot.append(MotionVW("motion"))
    robot.append(Pose("pose"))
    robot.add_default_interface("socket")
    Environment("empty")


def _entered(tick: Callable[[], object]) -> set[str]:
    files: set[str] = set()

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            files.add(frame.f_code.co_filename)

    sys.setprofile(note)
    try:
        tick()
    finally:
        sys.setprofile(None)
    return {str(Path(file).relative_to(_ROOT)) for file in files if Path(file).is_relative_to(_ROOT)}


def _motion(simulation: Simulation) -> dict[str, float]:
    motion = simulation.context.components["robot.motion"]
    return motion.local_data


def test_a_command_passes_few_files_and_none_of_what_has_no_work(monkeypatch) -> None:
    monkeypatch.setenv("MORSE_SOCKET_PORT", "0")
    with morse.load(_robot_on_a_socket, sockets=True) as simulation:
        simulation.step(30)
        (manager,) = simulation.context.stream_managers.values()
        port = manager._ports["robot.motion"]
        with closing(socket.create_connection(("127.0.0.1", port), timeout=60)) as client:
            for speed in (0.5, 1.0):  # the first command also lets the robot glide
                client.sendall(b'{"v": %f}\n' % speed)
                files: set[str] = set()
                for _ in range(100_000):
                    files = _entered(simulation.tick)
                    if _motion(simulation)["v"] == speed:
                        break
                simulation.step(30)
        assert _motion(simulation)["v"] == 1.0
        assert {"actuators/v_omega.py", "physics/world.py"} <= files
        assert len(files) <= _MOST, sorted(files)
        idle = ("services/", "simulation/handles/", "middleware/socket/request_manager.py", "physics/stability.py")
        assert not [file for file in files if file.startswith(idle)]


def test_a_tick_in_which_nothing_happens_asks_nobody() -> None:
    def still() -> None:
        Morsy("robot")
        Environment("empty")

    with morse.load(still) as simulation:
        simulation.step(300)
        files = _entered(simulation.tick)
    assert not [file for file in files if file.startswith(("services/", "middleware/", "simulation/handles/"))]
    assert len(files) <= 16, sorted(files)
