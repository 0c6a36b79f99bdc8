"""Midpoints."""

import math

x = y = yaw = 0.0


def update(way, turn):
    global x, y, yaw
    x += way * math.cos(yaw + turn / 2)
    y += way * math.sin(yaw + turn / 2)
    yaw = math.remainder(yaw + turn, math.tau)
    return x, y, yaw


def drift(bias, speed, seconds):
    return speed * bias * seconds**2 / 2
