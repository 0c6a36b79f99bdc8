"""Twelve lessons of robotics, from reactive control to search."""

#: from easy to hard
ORDER = [
    "line",
    "wall",
    "pid",
    "odometry",
    "dock",
    "tuning",
    "testing",
    "traffic",
    "mapping",
    "planning",
    "gates",
    "search",
]
