"""Every public name of the builder of MORSE 1.4 that its documents state, with parameters and defaults."""

import ast
import importlib
import inspect
from typing import Any

import pytest

import morse.builder
from morse.builder import bpymorse

#: the names of ``from morse.builder import *``
_NAMES = """
AbstractComponent Component Robot GroundRobot WheeledRobot PassiveObject Zone Environment Configuration
TimeStrategies bpymorse Cube Sphere Cylinder Cone Torus IcoSphere Plane Empty Mesh Coordsys Spot Camera
ComponentCreator SensorCreator ActuatorCreator math os sys pprint logging logger mathutils MorseError
MorseEnvironmentError MorseMiddlewareError MorseMultinodeError MorseServiceError MorseRPCInvokationError
MorseServiceAlreadyRunningError MorseMethodNotFoundError MorseWrongArgsError MorseRPCNbArgsError
MorseRPCTypeError MorseBuilderError MorseBuilderNoComponentError MorseBuilderUnexportableError FakeRobot Morsy
ATRV B21 Hummer Jido Pioneer3DX PatrolBot SegwayRMP400 QUAD2012 Quadrotor RMax Submarine Victim Human BarePR2
BasePR2 LocalizedPR2 NavPR2 Accelerometer Airspeed ArmaturePose Attitude Barometer Battery Clock Collision
CompoundSensor GPS Gyroscope HumanPosture IMU Sick Hokuyo SickLDMRS Infrared Magnetometer Odometry Pose
Proximity PTUPosture RadarAltimeter SearchAndRescue SemanticCamera StereoUnit Thermometer Velocity VideoCamera
DepthCamera RawImage Velodyne VelodyneRayCast VLP16_180 Kinect MotionVW MotionVWDiff MotionXYW Waypoint
Destination Teleport Orientation ForceTorque ExternalForce Drag SteerForce Keyboard Joystick
RotorcraftAttitude RotorcraftVelocity RotorcraftWaypoint StabilizedQuadrotor QuadrotorDynamicControl PTU
Gripper Armature KukaLWR PA10 Light Sound Arucomarker
"""
NAMES = _NAMES.split()

#: classes and methods; a parameter that the documents do not name is `_`
CALLS = """
AbstractComponent.append(obj, child=None, level=1)
AbstractComponent.translate(x=0, y=0, z=0)
AbstractComponent.rotate(x=0, y=0, z=0)
AbstractComponent.properties(**kwargs)
AbstractComponent.property_value(_)
AbstractComponent.get_child(name, objects=None, recursive=True)
AbstractComponent.add_stream(datastream, method=None, path=None, classpath=None, direction=None, **kwargs)
AbstractComponent.add_service(interface, component=None, config=None)
AbstractComponent.add_interface(interface, **kwargs)
AbstractComponent.add_overlay(datastream, overlay, config=None, **kwargs)
AbstractComponent.alter(modifier_name=None, classpath=None, direction=None, **kwargs)
AbstractComponent.level(_)
AbstractComponent.frequency(_)
AbstractComponent.profile()
AbstractComponent.set_color(r, g, b)
AbstractComponent.is_exportable()
AbstractComponent.mark_unexportable()
AbstractComponent.is_morseable()
AbstractComponent.morseable(calling_module=None)
AbstractComponent.select()
AbstractComponent.append_meshes(objects=None, component=None, prefix=None)
AbstractComponent.append_scenes()
AbstractComponent.append_collada()
AbstractComponent.close_context(level=1)
Component(category='', filename='', blender_object_name=None, make_morseable=True)
Robot(filename='', name=None, blender_object_name=None)
Robot.add_default_interface(stream)
Robot.set_friction(_=0.0)
Robot.set_mass(_)
Robot.make_external()
Robot.make_ghost(alpha=0.3)
Robot.set_rigid_body()
Robot.set_no_collision()
Robot.set_physics_type(_='STATIC')
Robot.set_dynamic()
Robot.set_collision_bounds()
Robot.set_use_record_animation(_)
Robot.make_grasper(obj_name)
GroundRobot(filename, name, blender_object_name=None)
WheeledRobot(filename, name, blender_object_name=None)
WheeledRobot.unparent_wheels()
FakeRobot(name=None)
Morsy(name)
Morsy.set_color(_)
ATRV(name=None)
B21(name=None)
Hummer(name=None)
Jido(name=None)
Pioneer3DX(name=None)
PatrolBot(name=None)
SegwayRMP400(name=None)
QUAD2012(name=None)
Quadrotor(name=None)
RMax(name=None)
Submarine(name=None)
Victim(name=None)
Human(filename='human_rig', name=None)
Human.add_interface(_)
BarePR2(name=None)
BasePR2(name=None, with_keyboard=True, show_laser=False)
LocalizedPR2(name=None)
NavPR2(name=None, with_keyboard=True, show_laser=False)
NavPR2.add_interface(_)
PassiveObject(filename='props/objects', prefix=None, keep_pose=False)
PassiveObject.setgraspable()
Zone(type)
Cube(name)
Mesh.color(r, g, b)
Spot(name, lamp_type='SPOT')
Camera(name)
Coordsys(name)
ComponentCreator(name, category, action, blendfile, blendobject, make_morseable)
Armature(name, armature_name, model_name)
Armature.create_ik_targets(_)
Joystick(name, index=0)
Kinect(name='Kinect')
Sound.open(path)
CompoundSensor(_)
Sick.create_laser_arc()
Environment(filename, main_scene=None, fastmode=False, component_renaming=True, auto_tune_time=True)
Environment.set_camera_location(_=(5, -5, 5))
Environment.set_camera_rotation(_=(0.7854, 0, 0.7854))
Environment.place_camera(_)
Environment.aim_camera(_)
Environment.set_camera_clip(clip_start=0.1, clip_end=100)
Environment.set_camera_speed(_=2.0)
Environment.set_camera_focal_length(_=20.0)
Environment.create(name=None)
Environment.set_horizon_color(_=(0.05, 0.22, 0.4))
Environment.set_ambient_color(_)
Environment.enable_mist(_)
Environment.set_mist_settings(enable, intensity, start, depth, falloff)
Environment.show_debug_properties(_)
Environment.show_framerate(_)
Environment.show_physics(_)
Environment.set_gravity(_=9.81)
Environment.set_material_mode(_)
Environment.set_viewport(_, clip_end=1000)
Environment.set_auto_start(_)
Environment.fullscreen(_)
Environment.set_debug(_)
Environment.set_stereo(mode='ANAGLYPH', eye_separation=0.1, stereo='STEREO')
Environment.set_animation_record(_)
Environment.set_background_scene(_)
Environment.save(filepath)
Environment.set_time_strategy(_)
Environment.set_time_scale(slowdown_by=None, accelerate_by=None)
Environment.simulator_frequency(base_frequency=60, logic_step_max=20, physics_step_max=20)
Environment.use_internal_syncer()
Environment.use_vsync(_)
Environment.use_relative_time(_)
Environment.set_physics_step_sub(_)
Environment.configure_multinode(protocol='socket', server_address='localhost', server_port='65000')
Environment.configure_stream_manager(_, **kwargs)
Environment.add_service(_)
Environment.configure_service(_)
Environment.select_display_camera(_)
Environment.set_log_level(component, level)
Environment.properties(**kwargs)
""".strip().splitlines()

MODULES = {
    "abstractcomponent": "AbstractComponent timer Configuration",
    "actuators": "MotionVW KukaLWR ActuatorCreator",
    "blenderobjects": "Cube Sphere Cylinder Cone Torus IcoSphere Plane Empty Mesh Coordsys Spot Camera",
    "bpymorse": "get_object get_objects get_material get_properties properties select_only delete set_speed fullscreen "
    "set_viewport get_context_object",
    "creator": "ComponentCreator SensorCreator ActuatorCreator bpymorse",
    "data": "MORSE_COMPONENTS MORSE_RESOURCE_PATH MORSE_DATASTREAM_MODULE Configuration",
    "environment": "Environment",
    "morsebuilder": "Component Robot GroundRobot WheeledRobot PassiveObject Zone Environment bpymorse",
    "robots": "ATRV Human NavPR2 Morsy",
    "sensors": "Pose Sick LaserSensorWithArc SensorCreator",
}


def test_names() -> None:
    assert [name for name in NAMES if name not in morse.builder.__all__] == []


@pytest.mark.parametrize("module", MODULES)
def test_modules(module: str) -> None:
    there = importlib.import_module(f"morse.builder.{module}")
    assert [name for name in MODULES[module].split() if not hasattr(there, name)] == []


def test_functions_of_bpymorse() -> None:
    assert list(inspect.signature(bpymorse.set_speed).parameters) == ["fps", "logic_step_max", "physics_step_max"]


@pytest.mark.parametrize("call", CALLS, ids=lambda call: call.partition("(")[0])
def test_signatures(call: str) -> None:
    path, _, arguments = call.partition("(")
    owner: Any = morse.builder
    for part in path.split("."):
        owner = inspect.getattr_static(owner, part) if inspect.isclass(owner) else getattr(owner, part)
    function = owner.__func__ if isinstance(owner, staticmethod) else owner
    ours = [p for p in inspect.signature(function).parameters.values() if p.name != "self"]
    wanted = ast.parse(f"call({arguments}".replace("**kwargs", "kwargs=...")).body[0]
    assert isinstance(wanted, ast.Expr)
    assert isinstance(wanted.value, ast.Call)
    position = 0
    for argument in _in_order(wanted.value):
        name = argument.arg if isinstance(argument, ast.keyword) else getattr(argument, "id", "")
        if name == "kwargs":
            assert any(p.kind is p.VAR_KEYWORD for p in ours)
            continue
        parameter = ours[position]
        assert parameter.kind is parameter.POSITIONAL_OR_KEYWORD, "1.4 takes it by position"
        assert name in ("_", parameter.name)
        if isinstance(argument, ast.keyword):
            assert parameter.default == ast.literal_eval(argument.value)
        position += 1
    assert all(p.default is not p.empty or p.kind in (p.VAR_KEYWORD, p.VAR_POSITIONAL) for p in ours[position:]), (
        "no other parameter is required"
    )


def _in_order(call: ast.Call) -> list[ast.expr | ast.keyword]:
    # a name after a keyword is a parameter whose default is not stated
    return sorted([*call.args, *call.keywords], key=lambda item: (item.lineno, item.col_offset))
