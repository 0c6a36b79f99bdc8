"""Components written for 1.4: the names of the scene, their robot and other components."""

import math

import pytest

SENSOR = '''
import logging; logger = logging.getLogger("morse." + __name__)
import mathutils
import morse.core.sensor
from morse.core.services import service
from morse.core import blenderapi, status
from morse.helpers.components import add_data, add_property
from morse.helpers.morse_math import normalise_angle

class Oracle(morse.core.sensor.Sensor):
    """ Answers questions """
    _name = "Oracle"
    _short_desc = "evaluates what it is asked"
    add_data('ticks', 0, 'int', 'number of measurements')
    add_property('_gain', 2.0, 'Gain', 'float', 'a number')

    def __init__(self, obj, parent=None):
        logger.info('%s initialization' % obj.name)
        super(self.__class__, self).__init__(obj, parent)
        logger.info('Component initialized')

    @service
    def ask(self, question):
        me, robot = self.bge_object, self.robot_parent.bge_object
        storage, objects = blenderapi.persistantstorage(), blenderapi.scene().objects
        names = dict(globals(), **locals())
        return eval(question, names)

    def default_action(self):
        self.local_data['ticks'] += 1

class Fragile(morse.core.sensor.Sensor):
    add_data('n', 0, 'int', 'n')
    def default_action(self):
        self.local_data['n'] += 1
        if self.local_data['n'] > 3:
            self.local_data['missing']['key'] = 1
'''

SCENE = """
from morse.builder import *

class Oracle(SensorCreator):
    _classpath = "oldlab.oracle.Oracle"
    def __init__(self, name=None):
        SensorCreator.__init__(self, name)
        mesh = Cube("OracleMesh")
        mesh.scale = (.05, .05, .02)
        self.append(mesh)

class Fragile(SensorCreator):
    _classpath = "oldlab.oracle.Fragile"

robot = ATRV()
oracle = Oracle()
oracle.translate(x=0.2, z=0.4)
oracle.properties(Gain=3.5)
robot.append(oracle)
fragile = Fragile()
robot.append(fragile)

other = ATRV()
other.translate(x=5.0)

box = PassiveObject('props/crates', 'small_crate')
box.translate(x=0.0, y=8.0)
box.setgraspable()

inside = Zone('Charging')
inside.size = [2., 2., 2.]
outside = Zone('Charging')
outside.translate(x=30)

robot.add_default_interface('socket')
env = Environment('empty', fastmode=True)
"""

FILES = {"src/oldlab/__init__.py": "", "src/oldlab/oracle.py": SENSOR, "scene.py": SCENE}


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("me.name", "robot.oracle"),
        ("me.parent is robot", True),
        ("me.parent.name", "robot"),
        ("me.children[0].name", "robot.oracle.OracleMesh"),
        ("robot.children['Wheel.1'].name", "Wheel.1"),
        ("'robot.oracle' in robot.children", True),
        ("'OracleMesh' in [c.name.split('.')[-1] for c in robot.childrenRecursive]", True),
        ("list(me.localPosition)", [0.2, 0.0, 0.4]),
        ("robot.mass", 20.0),
        ("'Robot_Tag' in robot, robot.get('nothing', 3), robot['classpath']", [True, 3, "morse.robots.atrv.ATRV"]),
        ("self.frequency", 60.0),
        ("self._gain", 3.5),
        ("self.name()", "robot.oracle"),
        ("self.robot_parent.name()", "robot"),
        ("self.periodic_call()", True),
    ],
)
def test_the_object_of_a_component(running, question, answer):
    assert running.call("robot.oracle", "ask", question) == answer


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("sorted(obj.name for obj in storage.robotDict)", ["other", "robot"]),
        ("storage.robotDict[robot].name()", "robot"),
        ("storage.robotDict[robot] is self.robot_parent", True),
        ("storage.externalRobotDict", None),
        ("storage.componentDict['robot.oracle'] is self", True),
        ("[obj.name for obj in storage.passiveObjectsDict]", ["box"]),
        ("sorted(storage.serviceObjectDict)", ["communication", "simulation", "time"]),
        (
            "storage.datastreams['robot.oracle']",
            [["morse.middleware.socket_datastream.SocketDatastreamManager", "OUT"]],
        ),
        ("list(storage.stream_managers)", ["morse.middleware.socket_datastream.SocketDatastreamManager"]),
        (
            "list(storage.morse_services.request_managers())",
            ["morse.middleware.socket_request_manager.SocketRequestManager"],
        ),
        ("storage.time.time == self.robot_parent.gettime()", True),
        ("storage.overlayDict", None),
        ("sorted(storage.zone_manager.contains(self))", ["inside"]),
        ("sorted(storage.zone_manager.contains(self, type='Charging'))", ["inside"]),
        ("sorted(storage.zone_manager.contains(self, name='outside'))", None),
        ("sorted(self.in_zones(type='Charging'))", ["inside"]),
        ("sorted(self.in_zones(type='Other'))", None),
        ("objects['Ground'].name", "Ground"),
        ("'Ground' in objects, 'Nothing' in objects, objects.get('Nothing')", [True, False, None]),
        ("objects[0].name in [obj.name for obj in objects]", True),
        ("blenderapi.version() >= (2, 65, 0)", True),
        ("blenderapi.isfastmode()", True),
    ],
)
def test_the_simulation_by_its_old_names(running, question, answer):
    # a falsy result is omitted from the reply
    assert running.call("robot.oracle", "ask", question) == answer


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        ("robot.getDistanceTo(objects['other'])", 5.0),
        ("robot.getVectTo(objects['other'])[0]", 5.0),
        ("list(robot.getVectTo(objects['other'])[1])", [1.0, 0.0, 0.0]),
        ("me.getDistanceTo(robot)", math.hypot(0.2, 0.4)),
        ("self.position_3d.distance_2d(self.robot_parent.position_3d)", 0.2),
        ("list(self.sensor_to_robot_position_3d().translation)", [0.2, 0.0, 0.4]),
        ("self.position_3d.z - self.robot_parent.position_3d.z", 0.4),
        (
            "list(mathutils.Euler((0, 0, 0.5)).to_matrix() * mathutils.Vector((1, 0, 0)))",
            [math.cos(0.5), math.sin(0.5), 0],
        ),
        (
            "list(mathutils.Euler((0, 0, 0.5)).to_matrix() @ mathutils.Vector((1, 0, 0)))",
            [math.cos(0.5), math.sin(0.5), 0],
        ),
        ("list((self.position_3d.matrix * mathutils.Matrix.Translation((1, 0, 0))).to_translation())[0]", 1.2),
        ("normalise_angle(1.5 * 3.141592653589793)", -0.5 * math.pi),
        ("normalise_angle(-7.0)", -7.0 + 2 * math.pi),
    ],
)
def test_distances_and_turns(running, question, answer):
    # the robots have settled a little into the ground
    assert running.call("robot.oracle", "ask", question) == pytest.approx(answer, abs=2e-3)


@pytest.mark.parametrize(
    ("ray", "name"),
    [
        # the body of a robot consists of shapes; hits report the robot
        ("robot.rayCast(objects['other'], None, 20)", "other"),
        ("robot.rayCast([10, 0, 0.3], [0, 0, 0.3], 20)", "other"),
        ("objects['other'].rayCast(robot, None, 20)", "robot"),
        ("robot.rayCast([10, 0, 0.3], [0, 0, 0.3], 20, 'Robot_Tag')", "other"),
        ("robot.rayCast([10, 0, 0.3], [0, 0, 0.3], 20, 'Robot_Tag', 0, 1)", "other"),
        ("robot.rayCast([0, 9, 0.5], None, 20)", "box"),
        ("robot.rayCast([0, 9, 0.5], None, 20, 'Graspable', 0, 1)", "box"),
        ("robot.rayCast([10, 0, 0.3], [0, 0, 0.3], 20, 'Graspable')", None),
        ("robot.rayCast([0, 0, 30], None, 40)", None),
    ],
)
def test_rays_meet_bodies(running, ray, name):
    hit = running.call("robot.oracle", "ask", f"[str(x) if x is None else x.name for x in {ray}[:1]]")
    assert hit == [str(name)]


def test_a_component_that_fails_is_reported_with_its_line_and_the_others_go_on(running):
    before = running.simu.robot.oracle.get()["ticks"]
    running.simu.sleep(0.2)
    line = next(line for line in running.log.splitlines() if "robot.fragile failed" in line)
    assert "[ERROR][MORSE]" in line
    assert "KeyError: 'missing'" in line
    number = SENSOR[: SENSOR.index("self.local_data['missing']")].count("\n") + 1
    assert f'oracle.py", line {number}, in default_action' in running.log
    assert running.simu.robot.oracle.get()["ticks"] > before


def test_what_components_log_names_them(running):
    assert "[oldlab.oracle] robot.oracle initialization\n" in running.log
