"""Where a corridor of the width of the robot is free, and where the robot has been least."""

import math

WIDTH = 0.95  # half of the corridor, m
visited = {}
side = 0.0


def free_way(points, heading):
    """How far a corridor is free, m."""
    cosine, sine = math.cos(heading), math.sin(heading)
    ahead = 6.0
    for x, y in points:
        along, across = x * cosine + y * sine, y * cosine - x * sine
        if along > 0.0 and abs(across) < WIDTH:
            ahead = min(ahead, along)
    return ahead


def step(pose, ranges):
    global side
    x, y, yaw = pose
    for i in (-1, 0, 1):
        for j in (-1, 0, 1):
            cell = math.floor(x) + i, math.floor(y) + j
            visited[cell] = visited.get(cell, 0) + 1
    angles = [math.radians(k - 90) for k in range(0, 181, 3)]
    points = [(r * math.cos(a), r * math.sin(a)) for r, a in zip(ranges[::3], angles, strict=True)]
    best, turn = 0.0, None
    for degrees in range(-90, 91, 10):
        heading = math.radians(degrees)
        free = free_way(points, heading)
        if free < 1.2:
            continue
        new = 0.0
        for far in (1.0, 2.0, 3.0, 4.0, 5.0):
            if far < free:
                cell = math.floor(x + far * math.cos(yaw + heading)), math.floor(y + far * math.sin(yaw + heading))
                new += 1.0 / (1 + 0.03 * visited.get(cell, 0))
        score = 1.0 + new - 0.004 * abs(degrees)
        if score > best:
            best, turn = score, heading
    here = free_way(points, 0.0)
    if turn is None or here < 1.0:
        side = side or (0.9 if sum(ranges[91:]) > sum(ranges[:90]) else -0.9)
        return 0.0, side
    side = 0.0
    return max(0.0, min(0.9, here - 0.9)) * max(0.1, 1 - abs(turn)), max(-1.2, min(1.2, 1.5 * turn))
