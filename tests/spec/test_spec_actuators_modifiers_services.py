"""Actuators, modifiers, overlays, levels and services that were written for 1.4."""

import time

import pytest

from pymorse import MorseServiceFailed, MorseServicePreempted

COMPONENTS = """
import logging; logger = logging.getLogger("morse." + __name__)
import json
import morse.core.actuator, morse.core.robot, morse.core.sensor
from morse.core import status, mathutils
from morse.core.exceptions import MorseRPCInvokationError
from morse.core.overlay import MorseOverlay
from morse.core.services import service, async_service, interruptible, noninterruptible
from morse.helpers.components import add_data, add_level, add_property
from morse.middleware import AbstractDatastream
from morse.middleware.socket_datastream import SocketPublisher
from morse.modifiers.abstract_modifier import AbstractModifier

class Mover(morse.core.actuator.Actuator):
    _name = "Mover"
    add_data('way', '', 'string', 'how to move')
    def __init__(self, obj, parent=None):
        super(Mover, self).__init__(obj, parent)
        self._goal = None
        self._left = 0

    @interruptible
    @async_service
    def goto(self, x):
        self._goal = float(x)

    @noninterruptible
    @async_service
    def count(self, ticks):
        self._left = ticks

    @async_service
    def undeclared(self):
        pass

    @service
    def refuse(self, why):
        raise MorseRPCInvokationError("refused: %s" % why)

    def interrupt(self):
        self._goal = None
        morse.core.actuator.Actuator.interrupt(self)

    def default_action(self):
        body, step = self.robot_parent.bge_object, 1.0 / self.frequency
        way = self.local_data['way']
        if way == 'movement': body.applyMovement([step, 0, 0], True)
        elif way == 'rotation': body.applyRotation([0, 0, step], True)
        elif way == 'velocity': body.setLinearVelocity([1.0, 0, 0], True)
        elif way == 'attribute': body.localLinearVelocity = [1.0, 0, 0]
        elif way == 'position': body.worldPosition = body.worldPosition + mathutils.Vector((step, 0, 0))
        elif way == 'speed': self.robot_parent.apply_speed('Velocity', [1.0, 0, 0], [0, 0, 0])
        if self._goal is not None:
            self.robot_parent.apply_speed('Velocity', [2.0, 0, 0], [0, 0, 0])
            if self.position_3d.x >= self._goal:
                self._goal = None
                self.completed(status.SUCCESS, "arrived")
        if self._left:
            self._left -= 1
            if not self._left:
                self.completed(status.FAILED, "counted")

class Machine(morse.core.robot.Robot):
    _name = 'machine'
    def __init__(self, obj, parent=None):
        morse.core.robot.Robot.__init__(self, obj, parent)
    @service
    def hello(self, who='you'):
        return "hello " + who
    def default_action(self):
        pass

class Gauge(morse.core.sensor.Sensor):
    add_level("coarse", "oldlab.parts.Coarse", doc="coarse")
    add_level("fine", "oldlab.parts.Fine", doc="fine", default=True)
    add_data('all', 1, 'int', 'in all levels')
    add_data('rough', 0, 'int', 'coarse', level="coarse")
    add_data('exact', 0, 'int', 'fine', level=["fine"])
    @service(name="kind")
    def name_of_class(self):
        return type(self).__name__
    def default_action(self):
        pass
class Coarse(Gauge):
    pass
class Fine(Gauge):
    pass

class Scale(AbstractModifier):
    def initialize(self):
        self.factor = float(self.parameter('factor', prop='Factor', default=1))
    def modify(self):
        try:
            self.data['x'] = self.factor * self.data['x']
            self.data['missing'] += 1
        except KeyError as detail:
            self.key_error(detail)
    def finalize(self):
        logger.info("modifier finalized")

class Short(SocketPublisher):
    def encode(self):
        return (json.dumps({'only': self.data['x']}) + '\\n').encode()

class Way(MorseOverlay):
    def __init__(self, overlaid_object, namespace=None):
        super(self.__class__, self).__init__(overlaid_object)
        self.namespace = namespace
    def name(self):
        return self.namespace or super(Way, self).name()
    def translated(self, answer):
        state, value = answer
        return (state, "translated " + value)
    @interruptible
    @async_service
    def move_to(self, x):
        self.overlaid_object.goto(self.chain_callback(self.translated), x)
"""

SCENE = """
from morse.builder import *

class Mover(ActuatorCreator):
    _classpath = "oldlab.parts.Mover"
    _blendname = "mover"
class Gauge(SensorCreator):
    _classpath = "oldlab.parts.Gauge"

for index, way in enumerate(['movement', 'rotation', 'velocity', 'attribute', 'position', 'speed']):
    robot = ATRV(way)
    robot.translate(x=-15, y=3 * index - 9)
    mover = Mover()
    robot.append(mover)
    pose = Pose()
    robot.append(pose)
    robot.add_default_interface('socket')
    AbstractComponent.close_context()

class Walker(GroundRobot):
    def __init__(self, name=None):
        GroundRobot.__init__(self, 'atrv', name)
        self.properties(classpath="oldlab.parts.Machine")
        self.legs = Mover()
        self.append(self.legs)
        self.legs.add_overlay('socket', 'oldlab.parts.Way', namespace='guide')

walker = Walker()
walker.translate(x=5, y=12)
walker.add_service('socket')
pose = Pose()
pose.alter('', 'oldlab.parts.Scale')
walker.append(pose)
twice = Pose()
twice.alter('', 'oldlab.parts.Scale', factor=2)
walker.append(twice)
short = Pose()
short.add_stream('socket', 'oldlab.parts.Short')
walker.append(short)
fine = Gauge()
walker.append(fine)
coarse = Gauge()
coarse.level('coarse')
walker.append(coarse)
walker.add_default_interface('socket')
env = Environment('empty', fastmode=True)
env.properties(Factor="10")
"""

FILES = {"src/oldlab/__init__.py": "", "src/oldlab/parts.py": COMPONENTS, "scene.py": SCENE}


@pytest.mark.parametrize(
    ("way", "axis"),
    [
        ("movement", "x"),
        ("rotation", "yaw"),
        ("velocity", "x"),
        ("attribute", "x"),
        ("position", "x"),
        ("speed", "x"),
    ],
)
def test_one_unit_a_second(running, way, axis):
    robot = getattr(running.simu, way)
    robot.mover.publish({"way": way})
    running.simu.sleep(0.3)
    before = robot.pose.get()
    running.simu.sleep(1.0)
    after = robot.pose.get()
    seconds = after["timestamp"] - before["timestamp"]
    robot.mover.publish({"way": ""})
    # friction slows a velocity that is set once per tick within the tick
    assert (after[axis] - before[axis]) / seconds == pytest.approx(1.0, rel=0.08)


def test_services_of_a_robot(running):
    assert running.simu.walker.hello().result() == "hello you"
    assert running.simu.walker.hello("me").result() == "hello me"


def test_a_refusal_reaches_the_caller(running):
    with pytest.raises(MorseServiceFailed, match="refused: so"):
        running.simu.walker.legs.refuse("so").result(60)


def test_wrong_numbers_of_arguments(running):
    with pytest.raises(TypeError, match="wrong # of parameters"):
        running.simu.walker.legs.refuse(1, 2).result(60)
    with pytest.raises(MorseServiceFailed, match="parameters are expected"):
        running.simu.walker.legs.refuse().result(60)


def test_a_new_call_preempts_an_interruptible_one(running):
    first = running.simu.walker.legs.goto(1000)
    second = running.simu.walker.legs.goto(-1000)
    with pytest.raises(MorseServicePreempted):
        first.result(60)
    assert second.result(60) == "arrived"


def test_a_new_call_is_refused_by_one_that_is_not_interruptible(running):
    first = running.simu.walker.legs.count(30)
    second = running.simu.walker.legs.count(1)
    with pytest.raises(MorseServiceFailed):
        second.result(60)
    with pytest.raises(MorseServiceFailed, match="counted"):
        first.result(60)


def test_cancelling(running):
    call = running.simu.walker.legs.goto(1000)
    deadline = time.monotonic() + 60.0
    while not call.running() and time.monotonic() < deadline:
        time.sleep(0.01)
    call.cancel()
    with pytest.raises(MorseServicePreempted):
        call.result(60)


def test_an_overlay_renames_and_translates(running):
    assert running.call("guide", "move_to", -1000) == "translated arrived"


def test_levels_choose_the_class_and_the_data(running):
    walker = running.simu.walker
    assert walker.fine.kind().result() == "Fine"
    assert walker.coarse.kind().result() == "Coarse"
    assert set(walker.fine.get()) == {"timestamp", "all", "exact"}
    assert set(walker.coarse.get()) == {"timestamp", "all", "rough"}


def test_parameters_of_modifiers_come_from_the_script_then_from_the_environment(running):
    x = running.simu.walker.short.get()["only"]
    assert running.simu.walker.twice.get()["x"] == pytest.approx(2 * x, rel=0.05)
    assert running.simu.walker.pose.get()["x"] == pytest.approx(10 * x, rel=0.05)


def test_a_field_that_a_modifier_misses_is_said_once(running):
    running.simu.sleep(0.2)
    assert running.log.count("walker.pose has no field 'missing' for Scale to change") == 1


def test_the_summary_names_the_modifiers(running):
    assert "\t- 'oldlab.parts.Scale'\n" in running.log
