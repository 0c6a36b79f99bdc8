"""Two robots explore rooms and share one map: each drives to the nearest frontier that is not near that of the other.

    python explore_together.py

The map is an occupancy grid of 0.15 m. A ray of a laser scanner makes the cells along it free, and the cell at its end
occupied. A frontier is a free cell beside an unknown one (Yamauchi 1997). Ways are shortest ways through free cells
that keep the distance of the body from everything occupied.
"""

import math
from collections import deque

import numpy as np

import morse

#: m; m/s; rad/s; ticks between two maps; distance from walls and others, m; range of rays, m
#: then the corner of the map, m, and the number of its cells
CELL, SPEED, TURN, TICKS, ROOM, RANGE = 0.15, 0.6, 1.2, 30, 0.6, 5.0
LOW, SIZE = np.array((-9.0, -6.0)), (120, 80)
STARTS = ((-1.0, 0.0), (1.0, 0.0))
MOST_MAPS = 300
#: middle and size of each wall, m: a hall of 16 m by 10 m, two rooms on each side, with doors of 1.6 m
WALLS = (
    *((0.0, side * 5.0, 16.2, 0.2) for side in (-1, 1)),
    *((side * 8.0, 0.0, 0.2, 10.2) for side in (-1, 1)),
    *((side * 3.0, y, 0.2, 2.6) for side in (-1, 1) for y in (-3.7, 3.7)),
    *((side * 3.0, 0.0, 0.2, 1.6) for side in (-1, 1)),
    *((side * 5.5, 0.0, 5.0, 0.2) for side in (-1, 1)),
    (0.0, 2.5, 1.0, 1.0),
)
_BESIDE = ((1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1))


def scene(count):
    """Some robots with laser scanners in a hall with rooms."""
    from morse.builder import Cube, Environment, LaserScanner, MotionVW, Pioneer3DX, Pose

    for number, (x, y) in enumerate(STARTS[:count]):
        robot = Pioneer3DX(f"robot{number}")
        robot.translate(x=x, y=y)
        motion, pose, scan = MotionVW("motion"), Pose("pose"), LaserScanner("scan")
        scan.translate(z=0.25)
        scan.properties(scan_window=360.0, resolution=1.0, laser_range=RANGE)
        for part in (motion, pose, scan):
            robot.append(part)
    for number, (x, y, along, across) in enumerate(WALLS):
        wall = Cube(f"wall{number}")
        wall.scale = (along / 2, across / 2, 0.5)
        wall.translate(x, y, 0.5)
        wall.static()
    Environment("empty")


def cell(points):
    """The cells of positions (N, 2), m."""
    return np.clip(((np.asarray(points) - LOW) / CELL).astype(int), 0, np.array(SIZE) - 1)


class SharedMap:
    """What all robots together have seen: votes of rays for each cell, positive for occupied."""

    def __init__(self):
        self.votes = np.zeros(SIZE)
        self.seen = np.zeros(SIZE, bool)
        # frontiers where a robot has been, and behind which nothing more is seen
        self.done = np.zeros(SIZE, bool)

    def add(self, here, scan, others):
        """Take the scan of a robot at a pose; what is at the places of other robots is no wall."""
        ranges = np.asarray(scan["range_list"])
        angles = here["yaw"] + np.linspace(-math.pi, math.pi, len(ranges))
        rays = np.stack((np.cos(angles), np.sin(angles)), axis=-1)
        begin = np.array((here["x"], here["y"]))
        steps = np.arange(0.0, RANGE, 0.5 * CELL)
        passed = (begin + steps[:, None] * rays[:, None])[steps < ranges[:, None] - CELL]
        free = np.unique(cell(passed), axis=0)
        ends = (begin + ranges[:, None] * rays)[ranges < RANGE - 0.01]
        for other in others:
            ends = ends[np.linalg.norm(ends - other, axis=1) > 0.5]
        hits = np.unique(cell(ends), axis=0)
        self.votes[free[:, 0], free[:, 1]] -= 1.0
        self.votes[hits[:, 0], hits[:, 1]] += 3.1
        self.seen |= self.votes != 0.0

    def way(self, here, others, taken, last):
        """The cells to a frontier: near the last one, else the nearest that nobody has taken; or None."""
        occupied = self.seen & (self.votes > 0.0)
        reach = math.ceil(ROOM / CELL)
        closed = np.zeros(SIZE, bool)
        for i, j in [*np.argwhere(occupied), *(cell(other) for other in others)]:
            closed[max(0, i - reach) : i + reach + 1, max(0, j - reach) : j + reach + 1] = True
        unknown, beside = np.pad(~self.seen, 1), np.zeros(SIZE, bool)
        for i, j in _BESIDE[:4]:
            beside |= unknown[1 + i : 1 + i + SIZE[0], 1 + j : 1 + j + SIZE[1]]
        start = i, j = tuple(map(int, cell(here)))
        self.done[max(0, i - 2) : i + 3, max(0, j - 2) : j + 3] = True
        goals = beside & self.seen & ~occupied & ~closed & ~self.done
        before, waiting, best = {start: start}, deque([start]), {}
        while waiting:
            now = waiting.popleft()
            if goals[now]:
                is_free = all(math.dist(now, other) * CELL > 3.0 for other in taken)
                best.setdefault((is_free and last is not None and math.dist(now, last) * CELL < 1.0, is_free), now)
            for i, j in _BESIDE:
                after = now[0] + i, now[1] + j
                # a robot that stands too near to a wall may drive away from it
                if (
                    after not in before
                    and self.seen[after]
                    and not occupied[after]
                    and (not closed[after] or closed[now])
                ):
                    before[after] = now
                    waiting.append(after)
        if not best:
            return None
        way = [best[max(best)]]
        while way[-1] != start:
            way.append(before[way[-1]])
        return way[::-1]


def explore(count=2):
    """Return the time, s, the free area on the map, m^2, and the least distance of a scanner from anything, m."""
    shared, nearest = SharedMap(), math.inf
    with morse.load(lambda: scene(count)) as sim:
        sim.step(2)
        robots = [getattr(sim, f"robot{number}") for number in range(count)]
        ways = [None] * count
        for _ in range(MOST_MAPS):
            poses = [robot.pose.data for robot in robots]
            places = [(pose["x"], pose["y"]) for pose in poses]
            for number, robot in enumerate(robots):
                others = [place for other, place in enumerate(places) if other != number]
                shared.add(poses[number], robot.scan.data, others)
                taken = [way[-1] for other, way in enumerate(ways) if way and other != number]
                ways[number] = shared.way(places[number], others, taken, ways[number] and ways[number][-1])
            if not any(ways):
                break
            for _ in range(TICKS):
                for robot, way in zip(robots, ways, strict=True):
                    robot.motion.publish(follow(robot.pose.data, way))
                sim.step()
                nearest = min(nearest, *(min(robot.scan.data["range_list"]) for robot in robots))
        free = np.count_nonzero(shared.seen & (shared.votes < 0.0)) * CELL**2
        return sim.clock.time, free, nearest


def follow(here, way):
    """The command that drives toward a point 0.3 m ahead on a way."""
    if not way:
        return {"v": 0.0, "w": 0.0}
    points = np.array(way) * CELL + LOW + 0.5 * CELL
    closest = int(np.argmin(np.linalg.norm(points - (here["x"], here["y"]), axis=1)))
    x, y = points[min(closest + 2, len(points) - 1)]
    error = math.remainder(math.atan2(y - here["y"], x - here["x"]) - here["yaw"], math.tau)
    return {"v": SPEED if abs(error) < 0.3 else 0.0, "w": max(-TURN, min(2.5 * error, TURN))}


if __name__ == "__main__":
    for robots in (1, 2):
        print("{} robots: {:.0f} s, {:.0f} m^2 free, never closer than {:.2f} m".format(robots, *explore(robots)))
