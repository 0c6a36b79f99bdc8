"""A Sphinx extension that lets the search of the documentation find pages by words that they do not contain.

Readers search for "lidar", "wheels" or "docker", and the pages say laser scanner, drive and container. The words become
keywords of the pages, which the index of the search contains. For components, they are the words by which the live view
finds them in its menu of models.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from docutils import nodes

if TYPE_CHECKING:
    from typing import Any

    from sphinx.application import Sphinx

#: pages, and what readers may search for instead of their words
WORDS = {
    "budgets": "limits quota security attack denial memory size",
    "cameras": "webcam photo video opencv rgb rgbd kinect realsense stereo lens distortion calibration segmentation",
    "ci": "github gitlab actions workflow jenkins docker pipeline",
    "command-line": "cli terminal shell options arguments flags remote",
    "compatibility": "versions supported tested",
    "connect": "middleware protocol interface communication network bridge which choose",
    "conventions": "units axes frames quaternion euler coordinates handedness metres degrees",
    "examples": "demo sample showcase gallery",
    "eyes": "rendering mujoco renderer offscreen egl osmesa gpu pixels",
    "facilities": "door lift elevator conveyor traffic building",
    "falsify": "fuzzing robustness counterexample failure adversarial stress safety verification",
    "fast-components": "slow speed optimise optimize profile numba vectorised vectorized",
    "first-steps": "quickstart start beginner introduction hello getting started",
    "foxglove": "visualise visualize dashboard studio plot websocket",
    "from-gazebo": "ignition sdformat world plugin launch migrate",
    "gym": "rl reinforcement train policy ppo stable baselines agent reward environment observation pettingzoo openai",
    "installation": "install setup pip docker container podman windows macos mac linux wsl conda venv headless server",
    "joints": "arm manipulator gripper hand legs quadruped humanoid servo moveit ik trajectory",
    "lessons": "course class classroom teacher student exercise homework school pid slam navigation",
    "live-view": "gui browser viewer window web ui editor screenshot jupyter notebook remote spectator",
    "many": "batch parallel vectorised vectorized throughput cluster",
    "mavlink": "px4 ardupilot qgroundcontrol mavsdk autopilot uav drone quadcopter sitl",
    "middleware": "protocol bridge zmq grpc custom",
    "migration": "upgrade port legacy blender old morse3",
    "models": "mesh import urdf xacro mjcf sdf gltf obj stl collada cad blender world environment map",
    "motivation": "why comparison alternatives isaac webots coppeliasim",
    "mqtt": "iot broker mosquitto",
    "multinode": "distributed several computers network hla",
    "nmea": "gps gnss gpsd serial",
    "other-simulators": "webots coppeliasim vrep isaac carla airsim pybullet stage player comparison",
    "people": "pedestrian crowd human walk actor social",
    "performance": "slow speed fast benchmark realtime fps cpu memory",
    "physics": "collision contact friction gravity mass inertia bullet mujoco wheels slip buoyancy drag aerodynamics",
    "policy": "semver deprecation support versions stability",
    "realism": "noise drift bias latency delay error calibration imu",
    "recipes": "howto snippet example code cookbook slam map teleop gamepad screenshot video gif",
    "recording": "rosbag bag mcap log replay film video gif csv export html black box",
    "ros1": "ros kinetic melodic noetic roscore rospy rviz",
    "ros2": "ros humble jazzy kilted rolling nav2 navigation rviz tf dds cyclone fastdds rclpy launch moveit",
    "rosbridge": "roslibjs roslibpy websocket browser javascript",
    "scenes": "script builder python world robot add append",
    "senses": "lidar radar sonar dvl event thermal infrared smell gas microphone ultrasound underwater",
    "services": "rpc call request action pause step teleport spawn reset",
    "simulation-object": "api library embed program python jupyter notebook headless save restore checkpoint snapshot",
    "socket": "tcp client json python pymorse matlab java cpp c++ javascript",
    "sun": "daylight night dusk dawn shadow solar elevation streetlight",
    "sweeps": "parameter study monte carlo grid search cluster ray hyperparameter optuna",
    "testing": "unittest pytest test assert regression junit",
    "time": "clock deterministic determinism reproducible realtime pause step speed seed random",
    "traffic": "cars vehicles road lane street autonomous driving",
    "troubleshooting": "error crash problem fails help faq black empty window slow install",
    "tutorial": "beginner start learn guide course first robot",
    "validation": "accuracy correct verified benchmark physics truth",
    "weather": "fog rain snow wind gust dust visibility sun",
    "yarp": "icub port yarpserver",
}
WORDS["library/models"] = WORDS["models"]


def words_of(page: str) -> set[str]:
    """The words by which a page is found besides its own."""
    return {*WORDS.get(page, "").split(), *component_words().get(page, "").split()}


_cache: dict[str, str] = {}


def component_words() -> dict[str, str]:
    """The words of components and robots, by their pages."""
    if not _cache:
        from component_library import component_pages, robot_pages

        from morse.builder.names import catalog
        from morse.launch.model_pictures import described_class

        kinds = {kind: component_pages.builder_classes(kind) for kind in ("sensors", "actuators")}
        for kind, classes in {"robots": robot_pages.robot_classes(), **kinds}.items():
            entries = catalog.components(f"morse.{kind}")
            for name, cls in classes.items():
                _cache[f"library/{kind}/{name.lower()}"] = described_class(cls, entries.get(name))[1]
    return _cache


def _keywords(app: Sphinx, document: nodes.document) -> None:
    words = sorted(word.lower() for word in words_of(app.env.docname) if word.replace("+", "").isalnum())
    if words:
        document.append(nodes.meta(name="keywords", content=", ".join(words)))


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx."""
    app.connect("doctree-read", _keywords)
    return {"parallel_read_safe": True}
