"""Scans at four positions, and draws the hits."""

import math

from pymorse import Morse

PLACES = [(0.0, 0.0), (6.0, 8.0), (-4.0, -6.0), (5.0, -8.0)]
CELL = 1.0  # m


def main():
    """Returns the cells with hits: column and row to the number of hits."""
    hits = {}
    with Morse() as simu:
        for x, y in PLACES:
            simu.robot.teleport.publish({"x": x, "y": y, "z": 0.02, "yaw": 0.0})
            simu.sleep(0.3)
            for px, py, _ in simu.robot.laser.get()["point_list"]:
                if px or py:
                    cell = math.floor((x + px) / CELL), math.floor((y + py) / CELL)
                    hits[cell] = hits.get(cell, 0) + 1
    return hits


def drawn(hits):
    """The plan as text, north at the top."""
    columns, rows = zip(*hits)
    across = range(min(columns), max(columns) + 1)
    return "\n".join(
        "".join("#" if hits.get((column, row), 0) > 1 else " " for column in across)
        for row in range(max(rows), min(rows) - 1, -1)
    )


if __name__ == "__main__":
    print(drawn(main()))
