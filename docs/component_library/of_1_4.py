"""The names that scene scripts of MORSE 1.4 can use."""

SENSORS = (
    "Accelerometer", "Airspeed", "ArmaturePose", "Attitude", "Barometer", "Battery", "Clock", "Collision",
    "CompoundSensor", "DepthCamera", "DepthCameraAggregator", "DepthCameraRotationZ", "GPS", "Gyroscope", "Hokuyo",
    "HumanPosture", "IMU", "Infrared", "Kinect", "Magnetometer", "Odometry", "Pose", "Proximity", "PTUPosture",
    "RadarAltimeter", "RawImage", "SearchAndRescue", "SemanticCamera", "Sick", "SickLDMRS", "StereoUnit",
    "Thermometer", "Velocity", "Velodyne", "VelodyneRayCast", "VelodyneZB", "VideoCamera", "VLP16_180",
)  # fmt: skip
ACTUATORS = (
    "Armature", "Arucomarker", "Destination", "Drag", "ExternalForce", "ForceTorque", "Gripper", "Joystick", "Keyboard",
    "KukaLWR", "Light", "MocapControl", "MotionVW", "MotionVWDiff", "MotionXYW", "Orientation", "PA10", "PTU",
    "QuadrotorDynamicControl", "RotorcraftAttitude", "RotorcraftVelocity", "RotorcraftWaypoint", "Sound",
    "StabilizedQuadrotor", "SteerForce", "Teleport", "Waypoint",
)  # fmt: skip
ROBOTS = (
    "ATRV", "B21", "BarePR2", "BasePR2", "FakeRobot", "Hummer", "Human", "Jido", "LocalizedPR2", "Morsy", "NavPR2",
    "PatrolBot", "Pioneer3DX", "QUAD2012", "Quadrotor", "RMax", "SegwayRMP400", "Submarine", "Victim",
)  # fmt: skip
MODIFIERS = ("ECEF", "feet", "geocentric", "geodetic", "IMUNoise", "NED", "OdometryNoise", "PoseNoise", "UTM")
ENVIRONMENTS = (
    "apartment", "empty", "human_tut/tutorial_scene", "indoors-1/boxes", "indoors-1/indoor-1", "laas/grande_salle",
    "land-1/buildings_1", "land-1/buildings_2", "land-1/rosace_1", "land-1/trees", "outdoors", "sandbox",
    "tum_kitchen/tum_kitchen", "water-1/deep_water", "water-1/water_scene",
)  # fmt: skip
MIDDLEWARES = ("hla", "mavlink", "moos", "pocolibs", "pprzlink", "ros", "socket", "text", "yarp", "yarp_json")
