"""Accelerates, steers to the left, and brakes."""

from pymorse import Morse


def speed(simu):
    """The speed of the car over the ground, m/s."""
    vx, vy, _ = simu.robot.velocity.get()["world_linear_velocity"]
    return (vx * vx + vy * vy) ** 0.5


def main():
    """Returns the speed before braking, m/s, the turning angle of the car, rad, and the final speed, m/s."""
    with Morse() as simu:
        simu.sleep(1.0)
        pedals, start = simu.robot.pedals, simu.robot.pose.get()["yaw"]
        while speed(simu) < 3.0:
            pedals.publish({"steer": 0.0, "force": -10.0, "brake": 0.0})  # negative is forward, as in MORSE 1.4
        pedals.publish({"steer": 0.3, "force": 0.0, "brake": 0.0})
        simu.sleep(2.0)
        fast, turned = speed(simu), simu.robot.pose.get()["yaw"] - start
        pedals.publish({"steer": 0.3, "force": 0.0, "brake": 20.0})
        simu.sleep(3.0)
        return fast, turned, speed(simu)


if __name__ == "__main__":
    print("Drove %.1f m/s, turned by %.2f rad, and stands: %.2f m/s." % main())
