"""A hovering robot dodges a ball that it sees by an event camera.

    python examples/senses/dodge_a_ball.py

Nothing else moves: all events are those of the ball. A ball that comes nearer grows: as soon as its events spread over
more than a tenth of the image, the robot moves aside, away from their middle.
"""

from __future__ import annotations

import math

import morse

START, SPEED, HEIGHT, RADIUS = 7.0, 9.0, 2.0, 0.15
WIDTH = 160


def scene() -> None:
    """Describe the world."""
    from morse.builder import Environment, EventCamera, FakeRobot, MotionXYW, Pose, Sphere

    robot = FakeRobot()
    robot.translate(z=HEIGHT)
    motion, eye, pose = MotionXYW(), EventCamera(), Pose()
    eye.properties(cam_width=WIDTH, cam_height=120, cam_fov=60.0, errors=True, noise_rate=0.01)
    for part in (motion, eye, pose):
        robot.append(part)
    ball = Sphere("ball")
    ball.scale = (RADIUS, RADIUS, RADIUS)
    ball.color(0.02, 0.02, 0.02)
    ball.set_rigid_body()
    ball.set_mass(0.3)
    ball.translate(START, 0.1, HEIGHT)
    Environment("empty").simulator_frequency(100)


def main(dodges: bool = True) -> float:
    """Throw the ball at the robot; return the smallest distance of both, m."""
    nearest, side = math.inf, 0.0
    with morse.load(scene, seed=1, sockets=False) as simulation:
        robot = simulation.robot
        ball = simulation.context.world.objects_by_name["ball"]
        simulation.step(2)
        time = START / SPEED
        ball.worldPosition = (START, 0.1, HEIGHT)
        ball.worldLinearVelocity = (-SPEED, -0.1 / time, 9.81 * time / 2.0)
        for _ in range(round(1.3 * time * 100)):
            simulation.step(1)
            events = robot.eye.data["events"]
            columns = events[:, 0]
            if dodges and side == 0.0 and len(events) > 40 and columns.std() > 0.03 * WIDTH:
                side = -1.0 if columns.mean() < WIDTH / 2.0 else 1.0
            robot.motion.publish({"x": 0.0, "y": 3.0 * side, "w": 0.0})
            here = robot.pose.data
            nearest = min(nearest, math.dist(ball.worldPosition, (here["x"], here["y"], here["z"])))
    print(f"The ball came as near as {nearest:.2f} m{'' if dodges else ', if the robot stays'}.")
    return nearest


if __name__ == "__main__":
    main(dodges=False)
    main()
