"""Follow the middle of what is dark."""

side = 1.0


def step(image):
    global side
    row = image[20][:, :3].astype(int).sum(axis=1)
    dark = [column for column in range(64) if row[column] < 240]
    if not dark:
        return 0.1, 0.8 * side
    error = (31.5 - sum(dark) / len(dark)) / 32
    side = 1.0 if error > 0 else -1.0
    return 0.9 - 0.5 * abs(error), 1.4 * error
