"""Dijkstra on a grid."""

import heapq
import math


def plan(boxes, start, goal):
    size = 0.25

    def free(cell):
        x, y = cell[0] * size, cell[1] * size
        inside = 0.5 <= x <= 15.5 and 0.5 <= y <= 11.5
        return inside and all(math.hypot(max(a - x, 0, x - c), max(b - y, 0, y - d)) > 0.52 for a, b, c, d in boxes)

    first, last = (tuple(round(part / size) for part in place) for place in (start, goal))
    best, before, queue = {first: 0.0}, {}, [(0.0, first)]
    while queue:
        length, here = heapq.heappop(queue)
        if here == last:
            way = [goal]
            while here != first:
                here = before[here]
                way.append((here[0] * size, here[1] * size))
            return [start, *way[::-1][1:]]
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                cell = here[0] + i, here[1] + j
                total = length + size * math.hypot(i, j)
                if (i or j) and free(cell) and total < best.get(cell, math.inf):
                    best[cell], before[cell] = total, here
                    heapq.heappush(queue, (total, cell))
    return None
