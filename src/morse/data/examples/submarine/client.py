"""Applies a thrust of 50 N for a while."""

from pymorse import Morse

THRUST = 50.0  # N


def main():
    """Returns the final speed, m/s: with F = C v^2 that is sqrt(50 / 8) = 2.5 m/s."""
    with Morse() as simu:
        simu.robot.engine.publish({"force": [THRUST, 0.0, 0.0], "torque": [0.0, 0.0, 0.0]})
        speed, before = 0.0, -1.0
        while speed - before > 1e-3 or speed < 0.1:
            simu.sleep(1.0)
            before, speed = speed, simu.robot.velocity.get()["linear_velocity"][0]
        return speed


if __name__ == "__main__":
    print("The speed of the boat is %.2f m/s." % main())
