"""From far and from near."""


def is_right(program, drive):
    for start in (5.0, 0.3):
        distances, speeds, touched = drive(program, start)
        if touched or max(map(abs, speeds)) > 1.0 or not 0.5 <= distances[-1] <= 1.5:
            return False
    return True
