"""The twin of ``c/walk.c`` in numpy."""

import heapq

import numpy as np

from morse.plugins.people.wayfinding import distance_to


def gap_at(points, gap, origin, cell):
    """The distances (N,) of points to the nearest wall, m, bilinear between the cells."""
    height, width = gap.shape
    place = (points - origin) / cell
    column = np.clip(np.floor(place[:, 0]), 0, width - 2).astype(np.intp)
    row = np.clip(np.floor(place[:, 1]), 0, height - 2).astype(np.intp)
    x, y = np.clip(place[:, 0] - column, 0.0, 1.0), np.clip(place[:, 1] - row, 0.0, 1.0)
    total = np.zeros(len(points))
    for r, c, weight in (
        (row, column, (1 - x) * (1 - y)),
        (row, column + 1, x * (1 - y)),
        (row + 1, column, (1 - x) * y),
        (row + 1, column + 1, x * y),
    ):
        total += weight * gap[r, c]
    return total


def directions(
    first, apart, velocity, distance, radii, position, wanted, speed, beside, present, gap, origin, cell, sight, turned
):
    """See `morse.kernel.walking.directions`."""

    def free_way(way):
        relative = way[first] * speed[first][:, None] - velocity
        closing = -(relative * apart).sum(axis=1)
        squared = np.maximum((relative * relative).sum(axis=1), 1e-9)
        least = np.minimum(radii, 0.98 * distance)
        root = closing * closing - squared * (distance * distance - least * least)
        meets = (closing > 0.0) & (root > 0.0)
        time = (closing[meets] - np.sqrt(root[meets])) / squared[meets]
        free = np.full(len(speed), sight)
        np.minimum.at(free, first[meets], np.maximum(time, 0.0) * speed[first[meets]])
        for ahead in (1.2, 0.6):
            shut = gap_at(position + ahead * way, gap, origin, cell) < beside
            free[shut] = np.minimum(free[shut], 0.5 * ahead)
        return free

    straight = free_way(wanted)
    involved = (straight < sight) & (wanted != 0.0).any(axis=1) & present
    best = sight * sight + straight * straight - 2.0 * sight * straight
    result = wanted.copy()
    for cosine, sine in turned:
        x, y = wanted.T
        way = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)
        free = free_way(way)
        cost = sight * sight + free * free - 2.0 * sight * free * cosine
        better = involved & (cost < best - 1e-9)
        best = np.where(better, cost, best)
        result[better] = way[better]
    return result


def arrival(time, is_free, slowness, seeds):
    """See `morse.kernel.walking.arrival`."""
    width = time.shape[1]
    times, free, slow = time.ravel(), is_free.ravel(), slowness.ravel()
    heap = [(times[seed], int(seed)) for seed in seeds]
    heapq.heapify(heap)
    while heap:
        reached, cell = heapq.heappop(heap)
        if reached > times[cell]:
            continue  # it has become nearer since then
        for after in (cell + 1, cell - 1, cell + width, cell - width):
            if not free[after]:
                continue
            a = min(times[after - 1], times[after + 1])
            b = min(times[after - width], times[after + width])
            low, high, step = min(a, b), max(a, b), slow[after]
            root = 2.0 * step * step - (high - low) ** 2 if high < np.inf else -1.0
            value = 0.5 * (low + high + np.sqrt(root)) if root > 0.0 and high - low < step else low + step
            if value < times[after]:
                times[after] = value
                heapq.heappush(heap, (value, after))


def wall(gap, polygon, rows, columns, origin, cell):
    """See `morse.kernel.walking.wall`."""
    x = origin[0] + cell * np.arange(columns.start, columns.stop)
    y = origin[1] + cell * np.arange(rows.start, rows.stop)
    points = np.stack(np.broadcast_arrays(x[None, :], y[:, None]), axis=-1).reshape(-1, 2)
    part = gap[rows, columns]
    np.minimum(part, distance_to(polygon, points).reshape(part.shape), out=part)
