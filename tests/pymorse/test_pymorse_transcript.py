"""The bytes between the client and a simulation."""

import json

import pytest
from scripted_simulation import ScriptedSimulation

from pymorse import Morse, MorseServiceFailed, MorseServicePreempted
from tests.kit.waiting import wait_until


def test_a_session_as_it_goes_over_the_wire(simulation: ScriptedSimulation) -> None:
    simulation.replies |= {
        "simulation list_streams": 'SUCCESS ["robot1.pose", "robot1.motion"]',
        "simulation get_all_stream_ports": 'SUCCESS {"robot1.pose": 60000, "robot1.motion": 60001}',
        "robot1.motion goto": 'SUCCESS "Arrived"',
        "time now": "SUCCESS 1795248708.0686975",
        "time sleep": "SUCCESS",
        "simulation activate": "SUCCESS",
        "simulation deactivate": "SUCCESS",
        "simulation reset_objects": 'SUCCESS "Objects restored to initial position"',
        "simulation quit": "SUCCESS",
    }
    simu = Morse("127.0.0.1", simulation.port)
    assert simu.rpc("simulation", "list_robots") == ["robot1"]
    assert simu.streams() == ["robot1.pose", "robot1.motion"]
    assert simu.rpc("simulation", "get_all_stream_ports") == {"robot1.pose": 60000, "robot1.motion": 60001}
    assert simu.robot1.motion.goto(2.5, 1.0, 0.0).result(60) == "Arrived"
    assert simu.time() == 1795248708.0686975
    simu.sleep(0.1)
    simu.activate("robot1.pose")
    simu.deactivate(simu.robot1.pose)
    assert simu.reset() == "Objects restored to initial position"
    simu.quit()
    assert not simu.is_up()
    assert simulation.rpc.lines == [
        b"0 simulation details []\n",
        b'1 simulation get_stream_port ["robot1.motion"]\n',
        b'2 simulation get_stream_port ["robot1.pose"]\n',
        b"3 simulation list_robots []\n",
        b"4 simulation list_streams []\n",
        b"5 simulation get_all_stream_ports []\n",
        b"6 robot1.motion goto [2.5, 1.0, 0.0]\n",
        b"7 time now []\n",
        b"8 time sleep [0.1]\n",
        b'9 simulation activate ["robot1.pose"]\n',
        b'10 simulation deactivate ["robot1.pose"]\n',
        b"11 simulation reset_objects []\n",
        b"12 simulation quit []\n",
    ]


def test_holding_the_clock(simulation: ScriptedSimulation) -> None:
    for service in ("pause", "resume", "step", "reset"):
        simulation.replies[f"simulation {service}"] = "SUCCESS"
    with Morse("127.0.0.1", simulation.port) as simu:
        simu.pause()
        simu.step()
        simu.step(60)
        simu.reset(seed=7)
        simu.resume()
    assert simulation.rpc.lines[3:] == [
        b"3 simulation pause []\n",
        b"4 simulation step [1]\n",
        b"5 simulation step [60]\n",
        b"6 simulation reset [7]\n",
        b"7 simulation resume []\n",
    ]


def test_cancelling_names_the_request_and_the_answer_is_its_own(simulation: ScriptedSimulation) -> None:
    simulation.replies["robot1.motion goto"] = None
    with Morse("127.0.0.1", simulation.port) as simu:
        going = simu.robot1.motion.goto(2.5, 1.0, 0.0)
        assert going.running()
        with pytest.raises(TimeoutError):
            going.result(0.01)
        assert going.cancel()
        wait_until(lambda: simulation.rpc.lines[-1] == b"3 cancel\n")
        assert not going.done()
        simulation.rpc.send(b"3 PREEMPTED\n")
        with pytest.raises(MorseServicePreempted):
            going.result(60)
        assert going.cancelled()
        assert not going.cancel()
    assert simulation.rpc.lines.count(b"3 cancel\n") == 1


def test_a_request_can_be_cancelled_by_its_number(simulation: ScriptedSimulation) -> None:
    simulation.replies["robot1.motion goto"] = None
    with Morse("127.0.0.1", simulation.port) as simu:
        going = simu.robot1.motion.goto(1.0)
        simu.cancel(3)
        simu.cancel(going)
        wait_until(lambda: simulation.rpc.lines[-2:] == [b"3 cancel\n", b"3 cancel\n"])
        simulation.rpc.send(b"3 PREEMPTED\n")
        assert isinstance(going.exception(60), MorseServicePreempted)


def test_failures_raise_what_1_4_raised(simulation: ScriptedSimulation) -> None:
    arity = "Socket service manager: wrong # of parameters for service. expected 3"
    unknown = "The request nope has not been registered in Socket service manager"
    simulation.replies |= {
        "robot1.motion goto": "FAILED " + json.dumps(arity),
        "robot1.motion nope": "FAILED " + json.dumps(unknown),
        "robot1.motion stop": "PREEMPTED",
    }
    with Morse("127.0.0.1", simulation.port) as simu:
        with pytest.raises(TypeError, match="wrong # of parameters for service"):
            simu.robot1.motion.goto(1).result(60)
        with pytest.raises(MorseServiceFailed, match=r"^The request nope has not been registered"):
            simu.rpc("robot1.motion", "nope")
        with pytest.raises(MorseServiceFailed) as failed:
            simu.get_stream_port("robot1.x")
        assert str(failed.value) == "Stream unavailable for component robot1.x"
        with pytest.raises(MorseServicePreempted):
            simu.robot1.motion.stop().result(60)


def test_a_result_that_is_false_is_not_on_the_wire(simulation: ScriptedSimulation) -> None:
    simulation.replies |= {"robot1.motion stop": "SUCCESS", "time now": "SUCCESS", "simulation list_streams": "SUCCESS"}
    with Morse("127.0.0.1", simulation.port) as simu:
        assert simu.robot1.motion.stop().result(60) is None
        assert simu.time() == 0.0
        assert simu.streams() == []


def test_a_sensor_is_read_and_an_actuator_is_written(simulation: ScriptedSimulation) -> None:
    line = b'{"timestamp": 1.14, "x": 2.5, "y": 1.0, "z": 0.0, "yaw": 0.0, "pitch": 0.0, "roll": 0.0}\n'
    with Morse("127.0.0.1", simulation.port) as simu:
        pose = simu.robot1["pose"]
        assert simulation.streams["robot1.pose"].accepted == 0, "an item has no connection before its first use"
        assert pose is simu.robot1.pose
        wait_until(lambda: simulation.streams["robot1.pose"].accepted)
        assert pose.last() is None
        simulation.streams["robot1.pose"].send(line)
        expected = {"timestamp": 1.14, "x": 2.5, "y": 1.0, "z": 0.0, "yaw": 0.0, "pitch": 0.0, "roll": 0.0}
        assert wait_until(pose.last) == expected
        simu.robot1.motion.publish({"v": 1.0, "w": 0.0})
        wait_until(lambda: simulation.streams["robot1.motion"].lines == [b'{"v": 1.0, "w": 0.0}\n'])
        assert simulation.streams["robot1.pose"].accepted == 1
