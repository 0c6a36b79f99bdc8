"""PID."""


class Controller:
    def __init__(self):
        self.sum, self.before = 0.0, None

    def step(self, target, height, seconds):
        error = target - height
        speed = 0.0 if self.before is None else (height - self.before) / seconds
        self.before = height
        force = 40.0 * error + self.sum - 18.0 * speed
        if 0.0 < force < 60.0 and abs(error) < 0.8:
            self.sum += 30.0 * error * seconds
        elif abs(error) >= 0.8:
            self.sum = 20.0
        return force


controller = Controller()


def step(target, height, seconds):
    return controller.step(target, height, seconds)
