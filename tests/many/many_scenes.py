"""Scenes of the tests of batches."""


def body(robot, mass=10.0, radius=0.2):
    """Give a robot a cylinder as its body."""
    from morse.builder import Cylinder

    shape = Cylinder(f"body_of_{robot.name}")
    shape.scale, shape.location = (radius, radius, 0.15), (0.0, 0.0, 0.15)
    game = shape._bpy_object.game
    game.physics_type, game.collision_bounds_type, game.use_collision_bounds = "RIGID_BODY", "CYLINDER", True
    robot.properties(GroundRobot=True)
    robot.append(shape)
    robot.set_rigid_body()
    robot.set_mass(mass)


def block(name, x, y, half_x, half_y, static=True):
    from morse.builder import Cube

    cube = Cube(name)
    cube.scale, cube.location = (half_x, half_y, 0.5), (x, y, 0.5)
    cube._bpy_object.game.physics_type = "STATIC" if static else "RIGID_BODY"
    return cube


def arena():
    """A planar robot with a scanner between four walls, 2 m from its start."""
    from morse.builder import Environment, MotionVW, Pose, Robot, Sick

    robot = Robot(name="robot")
    body(robot)
    laser = Sick("laser")
    laser.translate(0.0, 0.0, 0.2)
    laser.frequency(10)
    laser.level("range")
    for part in (MotionVW("motion"), Pose("pose"), laser):
        robot.append(part)
    walls = [(2.0, 0.0, 0.1, 2.0), (-2.0, 0.0, 0.1, 2.0), (0.0, 2.0, 2.0, 0.1), (0.0, -2.0, 2.0, 0.1)]
    for number, wall in enumerate(walls):
        block(f"Wall{number}", *wall)
    Environment("empty")


def crowded_arena():
    """A robot with sensors of many kinds, noise and a delay, beside a second robot and a crate."""
    from morse.builder import (
        GPS,
        IMU,
        Accelerometer,
        Clock,
        Collision,
        DepthVideoCamera,
        Environment,
        MotionVWDiff,
        MotionXYW,
        Odometry,
        Pioneer3DX,
        Pose,
        Proximity,
        Robot,
        Sick,
        VideoCamera,
    )

    robot = Pioneer3DX("robot")
    gps = GPS("gps")
    gps.noise(gaussian=0.1)
    pose = Pose("pose")
    pose.delay(0.07)
    laser = Sick("laser")
    laser.noise(gaussian=0.01, field="range_list")
    laser.frequency(7)
    camera, depth = VideoCamera("camera"), DepthVideoCamera("depth")
    for eye in (camera, depth):
        eye.properties(cam_width=16, cam_height=12)
        eye.translate(0.3, 0.0, 0.6)
    parts = [
        MotionVWDiff("motion"), gps, pose, laser, camera, depth, IMU("imu"), Odometry("odometry"),
        Accelerometer("accelerometer"), Collision("bumper"), Proximity("proximity"), Clock("clock"),
    ]  # fmt: skip
    for part in parts:
        robot.append(part)
    second = Robot(name="second")
    body(second)
    second.translate(1.5, 0.2, 0.0)
    for part in (MotionXYW("motion"), Pose("pose")):
        second.append(part)
    block("Crate", -1.5, 0.0, 0.3, 0.3, static=False)
    block("Wall", 3.0, 0.0, 0.1, 3.0)
    Environment("empty")


def fleet_arena():
    """Wheels, an arm, a pan-tilt unit, a drone and a robot that goes to a place, with sensors of further kinds."""
    from morse.builder import (
        ATRV,
        PTU,
        Armature,
        ArmaturePose,
        Attitude,
        Barometer,
        Battery,
        Bumper,
        DepthCamera,
        Environment,
        Gyroscope,
        Magnetometer,
        MotionVW,
        MotionVWDiff,
        NormalCamera,
        OpticalFlowCamera,
        Pioneer3DX,
        Pose,
        PTUPosture,
        Quadrotor,
        RotorcraftWaypoint,
        SegmentationCamera,
        SemanticCamera,
        StabilizedQuadrotor,
        Velocity,
        Waypoint,
        WheelEncoders,
    )

    wheels = Pioneer3DX("wheels")
    eyes = [SegmentationCamera("ids"), NormalCamera("normals"), OpticalFlowCamera("flow"), DepthCamera("points")]
    for eye in eyes:
        eye.properties(cam_width=12, cam_height=8)
        eye.translate(0.2, 0.0, 0.5)
    eyes[3].properties(keep_resolution=True)
    gyroscope = Gyroscope("gyroscope")
    gyroscope.noise(gaussian=0.01)
    for part in (MotionVWDiff("motion"), WheelEncoders("encoders"), gyroscope, Velocity("velocity"), *eyes):
        wheels.append(part)

    carrier = ATRV("carrier")
    carrier.translate(-3.0, 1.0, 0.1)
    unit, arm = PTU("unit"), Armature("arm", model_name="kuka_lwr")
    unit.append(PTUPosture("posture"))
    arm.append(ArmaturePose("angles"))
    arm.translate(0.0, 0.0, 0.9)
    semantic = SemanticCamera("semantic")
    semantic.properties(cam_width=12, cam_height=8)
    for part in (MotionVW("motion"), unit, arm, Bumper("bumper"), Battery("battery"), semantic, Pose("pose")):
        carrier.append(part)

    drone = Quadrotor("drone")
    drone.translate(0.0, 3.0, 2.0)
    for part in (RotorcraftWaypoint("motion"), Attitude("attitude"), Barometer("barometer"), Magnetometer("field")):
        drone.append(part)
    other = Quadrotor("other")
    other.translate(2.0, 3.0, 2.0)
    for part in (StabilizedQuadrotor("motion"), Pose("pose")):
        other.append(part)

    goer = ATRV("goer")
    goer.translate(3.0, -2.0, 0.1)
    for part in (Waypoint("motion"), Pose("pose")):
        goer.append(part)
    block("Crate", -1.5, 0.0, 0.3, 0.3, static=False)
    block("Wall", 4.5, 0.0, 0.1, 3.0)
    env = Environment("empty")
    env.properties(longitude=1.43, latitude=43.6, altitude=135.0)
