"""Drive to a goal among boxes, by a laser scanner or by a depth camera: tasks to begin with."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from gymnasium import spaces

from morse.gym.task import Command, Read, Task, Touch
from morse.mathutils import portable
from morse.scene import Bounds, PhysicsType

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from morse.gym.values import Arrays

#: half of the side of the arena, m; number of boxes; half of the side of a box, m
_HALF, _BOXES, _BOX = 5.0, 12, 0.3
#: sectors of the scan, and the distance beyond which all is free, m
_SECTORS, _FAR = 36, 3.0
#: height of the images of the depth camera, pixels; its focal length, mm: it sees 90 degrees
_HEIGHT, _WIDE = 4, 16.0
#: distance at which the goal is reached, m
_REACHED = 0.3


def boxes(layout: int) -> NDArray[np.float64]:
    """Return (12, 2) the centres of the boxes of a layout, m: none within 1 m of the centre or of another box."""
    rng, centres = np.random.default_rng(layout), np.empty((0, 2))
    while len(centres) < _BOXES:
        spot = rng.uniform(-4.4, 4.4, 2)
        if math.hypot(*spot) > 1.0 and (len(centres) == 0 or np.hypot(*(centres - spot).T).min() > 1.2):
            centres = np.vstack([centres, spot])
    return centres


def robot_with(name: str, *, by_camera: bool = False) -> Any:
    """Add a round robot of 0.4 m that senses by a scanner or by a depth camera to the scene, and return it."""
    from morse.builder import Cylinder, DepthVideoCamera, MotionVW, Pose, Robot, Sick

    robot, body = Robot(name=name), Cylinder("body")
    robot.properties(GroundRobot=True)
    body.scale, body.location = (0.2, 0.2, 0.15), (0.0, 0.0, 0.15)
    settings = body.scene_node.body
    settings.type, settings.bounds = PhysicsType.RIGID_BODY, Bounds.CYLINDER
    robot.append(body)
    robot.set_rigid_body()
    robot.set_mass(10.0)
    eye = DepthVideoCamera("depth") if by_camera else Sick("laser")
    eye.translate(0.0, 0.0, 0.35 if by_camera else 0.2)
    eye.frequency(10)
    if by_camera:
        eye.properties(cam_width=_SECTORS, cam_height=_HEIGHT, cam_focal=_WIDE)
    else:
        eye.level("range")
    for part in (MotionVW("motion"), Pose("pose"), eye):
        robot.append(part)
    return robot


def arena(layout: int, *, by_camera: bool = False) -> Callable[[], None]:
    """Return the scene of a layout: a robot with a scanner, or with a depth camera, in the middle of an arena."""

    def scene() -> None:
        from morse.builder import Cube, Environment

        def block(name: str, x: float, y: float, half_x: float, half_y: float) -> None:
            cube = Cube(name)
            cube.scale, cube.location = (half_x, half_y, 0.5), (x, y, 0.5)
            cube.static()

        edge = _HALF + 0.1
        for number, (x, y) in enumerate([(edge, 0.0), (-edge, 0.0), (0.0, edge), (0.0, -edge)]):
            block(f"Wall{number}", x, y, *((0.1, edge) if x else (edge, 0.1)))
        for number, (x, y) in enumerate(boxes(layout).tolist()):
            block(f"Box{number}", x, y, _BOX, _BOX)
        robot_with("robot", by_camera=by_camera)
        Environment("empty")

    scene.__name__ = f"arena {layout}"
    return scene


class Reach(Task):
    """Drive to a goal 1.5 to 4 m away, around boxes; a collision ends the episode.

    The observation is (40,): the nearest distance in 36 sectors of the scan, from -1 (touching) to 1 (3 m or more); the
    distance to the goal / 5 m; cosine and sine of its bearing; the last yaw rate, rad/s.

    Args:
        layouts: numbers of the arenas, which the rows use in turn.
    """

    ticks, limit, restarts = 6, 150, False
    by_camera: ClassVar[bool] = False
    action = Command("robot.motion", v=(0.0, 1.0), w=(-1.5, 1.5))
    observation = spaces.Box(-2.0, 4.0, (_SECTORS + 4,), np.float32)
    data: ClassVar[dict[str, Read | Touch]] = {
        "scan": Read("robot.laser", "range_list"),
        "pose": Read("robot.pose", "x", "y", "yaw"),
        "hit": Touch("robot"),
    }

    def __init__(self, layouts: Sequence[int] = tuple(range(64))) -> None:
        self._layouts = list(layouts)
        self.scene = [arena(layout, by_camera=self.by_camera) for layout in self._layouts]
        self._boxes = [boxes(layout) for layout in self._layouts]

    def start(self, rows: Sequence[int], rngs: Sequence[np.random.Generator]) -> None:
        """Place the robot and choose a goal, both in free space."""
        if "goal" not in self.values:
            self.values["goal"] = np.zeros((len(self.many), 2))
        poses = []
        for row, rng in zip(rows, rngs, strict=True):
            obstacles = self._boxes[(self.first_row + row) % len(self._boxes)]
            here, goal = _free(rng, obstacles), _free(rng, obstacles)
            while not 1.5 < math.hypot(*(here - goal)) < 4.0:
                here, goal = _free(rng, obstacles), _free(rng, obstacles)
            poses.append([*here, rng.uniform(-math.pi, math.pi)])
            self.values["goal"][row] = goal
        self.many.place(rows, "robot", poses)

    def observe(self, data: Arrays) -> NDArray[np.float32]:
        """See the class."""
        near, pose = self._near(data), data["pose"]
        ahead = data["goal"] - pose[:, :2]
        far = np.sqrt(ahead[:, 0] ** 2 + ahead[:, 1] ** 2)
        east, north = ahead.T / np.maximum(far, 1e-9)
        c, s = portable.cos(pose[:, 2]), portable.sin(pose[:, 2])
        parts = [far / 5.0, c * east + s * north, c * north - s * east, data["action"][:, 1]]
        return np.column_stack([np.minimum(near, _FAR) / (0.5 * _FAR) - 1.0, *parts]).astype(np.float32)

    def _near(self, data: Arrays) -> np.ndarray:
        """Return (N, 36) the nearest distance in each sector, m."""
        scan = data["scan"][:, 1:]
        nearest: np.ndarray = scan.reshape(len(scan), _SECTORS, -1).min(axis=2)
        return nearest

    def reward(self, before: Arrays, now: Arrays) -> tuple[np.ndarray, np.ndarray, Arrays]:
        """The way towards the goal, m; +5 at the goal, -5 for a collision."""
        was, far = (np.hypot(*(data["goal"] - data["pose"][:, :2]).T) for data in (before, now))
        reached = far < _REACHED
        crashed = now["hit"].astype(bool) & ~reached
        reward = 2.0 * (was - far) - 0.01 + 5.0 * reached - 5.0 * crashed
        return reward, reached | crashed, {"is_success": reached}


class ReachDepth(Reach):
    """The same by a depth camera, which looks ahead only.

    The observation is (40,), as for `Reach`: the sectors are the columns of the image, from left to right, 90 degrees.
    """

    by_camera = True
    data: ClassVar[dict[str, Read | Touch]] = {
        "depth": Read("robot.depth", "image"),
        "pose": Read("robot.pose", "x", "y", "yaw"),
        "hit": Touch("robot"),
    }

    def _near(self, data: Arrays) -> np.ndarray:
        # the first rows of the image are the lowest ones, which show the floor
        nearest: np.ndarray = data["depth"][:, _HEIGHT // 2 :].min(axis=1)
        return nearest


def _free(rng: np.random.Generator, obstacles: NDArray[np.float64]) -> NDArray[np.float64]:
    while True:
        spot = rng.uniform(-4.4, 4.4, 2)
        if np.hypot(*(obstacles - spot).T).min() > 0.85:
            return spot
