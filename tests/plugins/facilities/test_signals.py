"""Gates, traffic lights, buttons and messages of doors and lifts: they do what they are told, and say what is so."""

import re
from types import SimpleNamespace

import numpy as np
import pytest

import morse
from morse.core.exceptions import MorseError
from morse.plugins.facilities.ros import KINDS, MESSAGES
from morse.recording.recording import Recording
from morse.rosmsgs.cdr import decode
from tests.kit.scenes import Load, script

ROBOT = """
robot = ATRV()
robot.translate(x=-4.0, z=0.15)
motion = MotionVW()
robot.append(motion)
"""
EMPTY = '\nenv = Environment("empty")\n'


def until(simulation, condition, seconds: float = 60.0) -> None:
    for _ in range(int(seconds * 60)):
        if condition():
            return
        simulation.step(1)
    raise AssertionError("the condition did not come true")


def test_a_gate_holds_robots_back_until_it_is_open(load: Load):
    simulation = load(ROBOT + "gate = Gate(width=3.0, height=0.4, hold=600.0)" + EMPTY)
    robot = simulation.context.robots["robot"]
    simulation.robot.motion.set_speed(1.0, 0.0)
    simulation.step(360)
    assert robot.position_3d.x < -0.3
    simulation.robot.motion.set_speed(-1.0, 0.0)
    simulation.step(60)
    simulation.robot.motion.set_speed(0.0, 0.0)
    simulation.gate.open()
    until(simulation, lambda: simulation.gate.data["state"] == "open", 5.0)
    arm = simulation.context.world.objects_by_name["gate arm"]
    # upright at the hinge, which is at the right side
    assert tuple(arm.worldPosition) == pytest.approx((0.0, -1.5, 1.9), abs=1e-6)
    simulation.robot.motion.set_speed(1.0, 0.0)
    simulation.step(360)
    assert robot.position_3d.x > 1.0


def test_a_gate_does_not_come_down_on_a_robot(load: Load):
    simulation = load(ROBOT.replace("-4.0", "0.0") + "gate = Gate(hold=0.2)" + EMPTY)
    simulation.gate.open()
    until(simulation, lambda: simulation.gate.data["state"] == "open", 5.0)
    simulation.step(300)
    assert simulation.gate.data["state"] == "open"
    simulation.robot.motion.set_speed(1.0, 0.0)
    until(simulation, lambda: simulation.gate.data["state"] == "closed", 20.0)
    assert simulation.context.robots["robot"].position_3d.x > 0.8


LIGHT = """
light = TrafficLight(phases=[("green", 2.0), ("yellow", 1.0), ("red", 3.0), ("red-yellow", 1.0)], offset=1.0)
eye = FakeRobot()
eye.translate(x=3.0, z=2.75)
eye.rotate(z=3.141592653589793)
camera = VideoCamera()
camera.properties(cam_width=96, cam_height=96, cam_fov=25.0)
eye.append(camera)
env = Environment("empty")
"""


def _colors(picture: np.ndarray) -> set[str]:
    """The lights that shine in a picture."""
    red, green, blue = (picture[..., channel].astype(int) for channel in range(3))
    found = set()
    if ((red > 200) & (green < 110) & (blue < 110)).sum() > 20:
        found.add("red")
    if ((red > 200) & (green > 150) & (blue < 110)).sum() > 20:
        found.add("yellow")
    if ((green > 200) & (red < 120)).sum() > 20:
        found.add("green")
    return found


def test_a_traffic_light_follows_its_schedule_and_is_seen(load: Load):
    simulation = load(LIGHT)
    seen = []
    for time, state in ((0.5, "green"), (1.5, "yellow"), (3.0, "red"), (5.5, "red-yellow"), (7.0, "green")):
        simulation.step(round(60 * time) - round(60 * simulation.context.clock.time))
        assert simulation.light.data["state"] == state
        picture = np.asarray(simulation.eye.camera.get()["image"]).reshape(96, 96, -1)
        seen.append(_colors(picture) == set(state.split("-")))
    assert all(seen)


def test_a_client_sets_a_traffic_light(load: Load):
    simulation = load(LIGHT)
    simulation.light.show("off")
    simulation.step(10)
    assert simulation.light.data["state"] == "off"
    assert simulation.light.data["remaining"] == float("inf")
    picture = np.asarray(simulation.eye.camera.get()["image"]).reshape(96, 96, -1)
    assert _colors(picture) == set()
    state = simulation.save()
    simulation.light.show("red")
    simulation.step(5)
    simulation.restore(state)
    bright = [one for name, one in simulation.context.world.objects_by_name.items() if name.endswith(" on")]
    assert not any(one.visible for one in bright)
    simulation.light.resume()
    simulation.step(1)
    assert simulation.light.data["state"] == "green"
    with pytest.raises(Exception, match="'blue'"):
        simulation.light.show("blue").result()


BUTTON = """
button = Button(size=0.3)
button.translate(x=0.0, z=0.3)
button.rotate(z=3.141592653589793)
door = Door()
door.translate(y=9.0)
lift = Lift()
lift.translate(y=-9.0)
button.calls(door, "open")
button.calls("lift", "call", 1)
"""


def test_a_robot_presses_a_button_by_touch(load: Load):
    simulation = load(ROBOT + BUTTON + EMPTY)
    simulation.step(30)
    assert simulation.button.data["count"] == 0
    simulation.robot.motion.set_speed(1.0, 0.0)
    until(simulation, lambda: simulation.button.data["count"] == 1, 10.0)
    assert simulation.context.robots["robot"].position_3d.x == pytest.approx(-0.6, abs=0.2)
    simulation.step(30)
    assert simulation.button.data == simulation.button.data | {"count": 1, "pressed": True, "refused": ""}
    until(simulation, lambda: simulation.door.data["state"] == "open", 5.0)
    until(simulation, lambda: simulation.lift.data["level"] == 1 and simulation.lift.data["state"] == "open", 20.0)
    simulation.robot.motion.set_speed(-1.0, 0.0)
    until(simulation, lambda: not simulation.button.data["pressed"], 5.0)


def test_people_press_a_button_by_presence(load: Load):
    scene = """
door = Door(kind="sliding")
door.translate(y=5.0)
button = Button(reach=1.0)
button.translate(x=2.0, y=0.6, z=1.1)
button.calls(door, "open")
crowd = Crowd("crowd", 1)
crowd.start(places=[(-2.0, 0.0)])
crowd.goals([(2.0, 0.0)])
"""
    simulation = load(scene + EMPTY)
    until(simulation, lambda: simulation.button.data["count"] == 1, 20.0)
    place = np.asarray(simulation.context.robots["crowd"].local_data["positions"])[0]
    assert np.hypot(place[0] - 2.0, place[1] - 0.6) == pytest.approx(1.0, abs=0.05)
    until(simulation, lambda: simulation.door.data["openness"] > 0.0, 1.0)


def test_a_button_tells_what_was_refused(load: Load):
    simulation = load(ROBOT + BUTTON + EMPTY)
    simulation.door.lock()
    simulation.button.press()
    simulation.step(2)
    assert "locked" in simulation.button.data["refused"]
    assert simulation.lift.data["destination"] == 1
    assert not simulation.failures


def test_a_button_whose_door_was_deleted_tells_so_and_calls_the_others(load: Load):
    simulation = load(ROBOT + BUTTON + EMPTY)
    simulation.delete("door")
    simulation.button.press()
    simulation.step(2)
    assert "'door', which does not exist" in simulation.button.data["refused"]
    assert simulation.lift.data["destination"] == 1
    assert not simulation.failures


@pytest.mark.parametrize(
    ("link", "words"),
    [
        ('button.calls("dor", "open")', "'dor', which does not exist; did you mean 'door'"),
        ('button.calls(door, "opne")', "no service 'opne' to call; did you mean 'open'"),
        ('button.calls(lift, "call", "up")', "button calls lift.call"),
        ('button.calls(lift, "call")', "button calls lift.call"),
    ],
)
def test_a_button_with_a_wrong_link_is_named_at_the_start(load: Load, link: str, words: str):
    # when the scene is loaded, not when it is pressed
    with pytest.raises(Exception, match=rf"robot 'button' \(.*:\d+\): .*{re.escape(words)}"):
        load(ROBOT + BUTTON + link + EMPTY)


def test_states_agree(load: Load):
    simulation = load(ROBOT + BUTTON + "gate = Gate(automatic=3.0)\nlight = TrafficLight()" + EMPTY)
    simulation.robot.motion.set_speed(1.0, 0.0)
    simulation.step(100)
    state = simulation.save()
    simulation.step(200)
    end = simulation.save()
    simulation.restore(state)
    simulation.step(200)
    assert simulation.save() == end


RMF = """
door = Door(hold=1.0)
lift = Lift(levels=(0.0, 3.0, 6.0))
lift.translate(y=9.0)
for target, state, request in ((door, DoorState, DoorRequest), (lift, LiftState, LiftRequest)):
    for part in (state("state"), request("request")):
        part.frequency(60)
        target.append(part)
env = Environment("empty")
"""


def test_doors_follow_requests_of_open_rmf(load: Load):
    simulation = load(RMF)
    simulation.door.request.publish({"door_name": "door", "requested_mode": 2})
    until(simulation, lambda: simulation.door.state.data["current_mode"] == 2, 10.0)
    simulation.step(300)
    assert simulation.door.state.data["current_mode"] == 2
    simulation.door.request.publish({"door_name": "another", "requested_mode": 0})
    simulation.step(30)
    simulation.door.request.publish({"door_name": "door", "requested_mode": 0})
    until(simulation, lambda: simulation.door.state.data["current_mode"] == 0, 10.0)


def test_lifts_follow_requests_of_open_rmf(load: Load):
    simulation = load(RMF)
    request = {"lift_name": "lift", "session_id": "fleet", "request_type": 1, "destination_floor": "2", "door_state": 2}
    simulation.lift.request.publish(request)
    until(simulation, lambda: simulation.lift.state.data["motion_state"] == 1, 10.0)
    until(simulation, lambda: simulation.lift.state.data["door_state"] == 2, 30.0)
    assert simulation.lift.state.data["current_floor"] == "2"
    assert simulation.lift.state.data["available_floors"] == ["0", "1", "2"]
    simulation.step(600)
    assert simulation.lift.state.data["door_state"] == 2
    simulation.lift.request.publish(request | {"destination_floor": "9" * 5000})
    simulation.step(10)
    simulation.lift.request.publish(request | {"request_type": 0})
    until(simulation, lambda: simulation.lift.state.data["door_state"] == 0, 30.0)
    assert not simulation.failures


def test_the_level_of_a_lift_is_the_floor_that_it_has_passed(load: Load):
    simulation = load(RMF)
    data = simulation.context.robots["lift"].local_data
    simulation.lift.call(2)
    seen = []
    for _ in range(2):
        until(simulation, lambda: data["speed"] != 0.0, 30.0)
        while data["speed"] != 0.0:
            seen.append((data["height"], data["level"]))
            simulation.step(1)
        simulation.lift.call(0)
    peak = max(range(len(seen)), key=lambda one: seen[one][0])
    assert {level for height, level in seen[:peak] if 0.1 < height < 2.9} == {0}
    assert {level for height, level in seen[:peak] if 3.1 < height < 5.9} == {1}
    assert {level for height, level in seen[peak:] if 3.1 < height < 5.9} == {2}
    assert {level for height, level in seen[peak:] if 0.1 < height < 2.9} == {1}


def test_get_of_a_lift_says_how_to_read_it(load: Load):
    with pytest.raises(AttributeError, match="read data"):
        load(RMF).lift.get()


@pytest.mark.parametrize(
    ("call", "words"),
    [
        ("Gate(width=0)", "Gate(width)"),
        ("Gate(hold=float('nan'))", "Gate(hold)"),
        ("TrafficLight(phases=[])", "1 to 1000 phases"),
        ("TrafficLight(phases='green')", "takes pairs such as"),
        ("TrafficLight(phases=[('blue', 2.0)])", "one of red"),
        ("TrafficLight(phases=[('gren', 2.0)])", "did you mean 'green'"),
        ("TrafficLight(phases=[('red', 0.0)])", "at least 0.1"),
        ("TrafficLight(phases=[('red',)])", "takes pairs such as"),
        ("TrafficLight(phases=__import__('itertools').repeat(('red', 1.0)))", "1 to 1000 phases"),
        ("TrafficLight(offset=-1)", "TrafficLight(offset)"),
        ("Button(reach='near')", "Button(reach)"),
        ("Button().calls(3, 'open')", "Button.calls(target)"),
        ("Button().calls('door', 5)", "Button.calls(service)"),
        ("Button().calls('door', 'open', object())", "Button.calls(arguments)"),
        ("Button().calls('door', 'open', float('nan'))", "Button.calls(arguments)"),
    ],
)
def test_mistakes_are_named(tmp_path, call: str, words: str):
    with pytest.raises(Exception, match=re.escape(words)):
        morse.load(script(tmp_path, f'one = {call}\nenv = Environment("empty")')).close()


def test_the_messages_are_those_of_open_rmf(tmp_path):
    file = tmp_path / "run.mcap"
    with morse.load(script(tmp_path, RMF), sockets=False, record=str(file)) as simulation:
        simulation.door.open()
        simulation.lift.call(1)
        simulation.step(60)
    with Recording(file) as recording:
        found = {
            channel.topic: (
                channel.type,
                decode(channel.type, bytes(list(recording.messages({channel.number}))[-1].data)),
            )
            for channel in recording.channels.values()
            if channel.topic in ("/door/state", "/lift/state")
        }
    name, door = found["/door/state"]
    assert name == "rmf_door_msgs/msg/DoorState"
    assert (door["door_name"], door["current_mode"]["value"], door["door_time"]["sec"]) == ("door", 1, 1)
    name, lift = found["/lift/state"]
    assert name == "rmf_lift_msgs/msg/LiftState"
    assert lift["available_floors"] == ["0", "1", "2"]
    assert (lift["lift_name"], lift["destination_floor"], lift["motion_state"], lift["current_mode"]) == (
        "lift",
        "1",
        1,
        2,
    )


def test_requests_of_open_rmf_become_commands():
    topics = MESSAGES.topics
    inlets = {kind.name: topics.inlets(None, SimpleNamespace(kind=kind)) for kind in KINDS}  # type: ignore[arg-type]
    (door,), (lift,) = inlets["door_request"], inlets["lift_request"]
    request = {"request_time": {}, "requester_id": "me", "door_name": "door", "requested_mode": {"value": 2}}
    assert door.take(request) == {"door_name": "door", "requested_mode": 2}
    floor = {"lift_name": "lift", "session_id": "a", "request_type": 1, "destination_floor": "2", "door_state": 2}
    assert lift.take(floor | {"request_time": {}}) == floor


@pytest.mark.parametrize("part", ["DoorState", "DoorRequest", "LiftState", "LiftRequest"])
def test_a_part_that_is_mounted_elsewhere_says_so(load: Load, caplog: pytest.LogCaptureFixture, part: str):
    simulation = load(f"robot = FakeRobot()\nrobot.append({part}('part'))" + EMPTY)
    simulation.step(3)
    assert f".append({part}())" in caplog.text
    assert not simulation.failures


@pytest.mark.parametrize(
    ("line", "name"),
    [
        *((f"one = TrafficLight()\none.scene_node.properties.update(Phases={text!r})", "Phases") for text in (
            "nonsense", "[]", '[["green", 0]]', '[["blue", 1]]', '[["green"]]', "5", "[" * 100_000,
            '[["green", NaN]]')),
        *((f"one = Lift()\none.scene_node.properties.update(Levels={text!r})", "Levels") for text in (
            "x", "[0]", "[0, 1, 2]", "[0, NaN]")),
        *((f"one = Lift()\none.scene_node.properties.update(Size={text!r})", "Size") for text in (
            "x", "[1]", "[1, 1, 1e400]")),
        *((f"one = Dispenser()\none.scene_node.properties.update(Size={text!r})", "Size") for text in (
            "x", "{}", '["a", "b", "c"]')),
    ],
)  # fmt: skip
def test_properties_that_the_classes_write_are_checked(load: Load, line, name):
    with pytest.raises(MorseError, match=f"^(?s:.)*the property '{name}' is (?!.*File)"):
        load(line + EMPTY)


@pytest.mark.parametrize(
    ("cls", "name", "what"),
    [
        ("Button", "Calls", "Button.calls"),
        ("Lift", "Levels", "Lift(levels=...)"),
        ("Lift", "Size", "Lift(size=..., height=...)"),
        ("TrafficLight", "Phases", "TrafficLight(phases=...)"),
        ("Dispenser", "Boxes", "Dispenser(stock=...)"),
        ("Traffic", "Roads", "Traffic.road(...)"),
        ("Traffic", "Stops", "Traffic.stop(...)"),
        ("Traffic", "Lengths", "Traffic.road(count=...)"),
        ("Crowd", "Plan", "Crowd.start(...)"),
    ],
)
def test_what_classes_of_scripts_write_is_refused_from_scripts_and_clients(load: Load, cls: str, name: str, what: str):
    words = re.escape(f"property '{name}' of ") + r"\w+ is written by " + re.escape(what)
    more = "one.start(places=[(0, 0)])\n" if cls == "Crowd" else ""
    with pytest.raises(MorseError, match=rf":\d+: {words}"):
        load(f"one = {cls}()\n{more}one.properties({name}='[]')" + EMPTY)
    simulation = load(f"one = {cls}()\n{more}" + EMPTY)
    with pytest.raises(Exception, match=words):
        simulation.one.set_property(name, "[]").result()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ("Speed='fast'", "property 'Speed' of Lift is 'fast', expected a number from 0.05 to 20 m/s"),
        ("Speed=float('nan')", "property 'Speed' of Lift is nan, expected a number from 0.05 to 20 m/s"),
        ("Speed=99.0", "property 'Speed' of Lift is 99.0, expected a number from 0.05 to 20 m/s"),
        ("Hold=[1.0]", "property 'Hold' of Lift is [1.0], expected a number"),
    ],
)
def test_properties_of_robots_are_checked_as_those_of_sensors(load: Load, given: str, words: str):
    with pytest.raises(MorseError, match=rf":\d+: {re.escape(words)}"):
        load(f"one = Lift()\none.properties({given})" + EMPTY)


def test_texts_of_numbers_and_properties_of_ones_own_stay(load: Load):
    simulation = load("one = Lift()\none.properties(Speed='7.5', Object=True, my_tag='a')" + EMPTY)
    assert simulation.one.get_properties().result()["properties"]["Speed"][0] == 7.5
    assert simulation.world.game_object("one").node.properties["my_tag"] == "a"
