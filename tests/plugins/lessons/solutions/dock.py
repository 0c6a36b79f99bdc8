"""Turn to the post, and drive until it is wide enough."""

import numpy as np


def step(image):
    red, green, blue = (np.asarray(image)[:, :, k].astype(int) for k in range(3))
    orange = (red > 90) & (red > 1.5 * green) & (red > 2 * blue)
    columns = np.nonzero(orange.any(axis=0))[0]
    if not len(columns):
        return 0.0, 0.6
    error = (31.5 - columns.mean()) / 32
    width = columns[-1] - columns[0] + 1
    if width >= 14:
        return (0.0, 0.0) if abs(error) < 0.1 else (0.0, 0.8 * error)
    return 0.5 if abs(error) < 0.3 else 0.0, 1.2 * error
