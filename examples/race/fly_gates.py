"""A quadrotor races through four gates along the fastest way, which CasADi computes, and against the wind.

pip install casadi
python fly_gates.py
"""

import math
from functools import partial

import casadi
import numpy as np

import morse

#: centre of each gate, m, and the direction to fly through it, rad
GATES = [(4.0, 0.0, 1.8, 0.0), (8.0, 3.0, 2.8, 1.0), (6.0, 8.0, 2.3, 2.6), (0.0, 7.0, 1.8, -2.6)]
START, FASTEST, STRONGEST, STEPS = (0.0, 0.0, 1.0), 3.0, 2.5, 15
#: 1/s^2 and 1/s: gains of errors of place and velocity; m/s^2; kg; N: largest thrust; m: half of an opening
STIFF, DAMPED, GRAVITY, MASS, THRUST, HALF = 9.0, 5.0, 9.81, 2.0, 40.0, 0.8


def scene(wind=0.0):
    """A quadrotor, and the four posts and bars of each gate."""
    from morse.builder import Cube, Environment, Pose, Quadrotor, RotorcraftAttitude, Velocity

    drone = Quadrotor("drone")
    drone.translate(*START)
    drone.set_mass(MASS)
    for part in (RotorcraftAttitude("pilot"), Pose("pose"), Velocity("velocity")):
        drone.append(part)
    for k, (x, y, z, yaw) in enumerate(GATES):
        for part, (side, up, width, height) in enumerate(
            ((-0.9, 0, 0.1, 1.0), (0.9, 0, 0.1, 1.0), (0, 0.9, 0.8, 0.1), (0, -0.9, 0.8, 0.1))
        ):
            bar = Cube(f"gate_{k}_{part}")
            bar.location = (x - side * math.sin(yaw), y + side * math.cos(yaw), z + up)
            bar.rotation_euler = (0.0, 0.0, yaw)
            bar.scale = (0.05, width, height)
            bar.static()
    env = Environment("empty")
    env.weather(wind=(wind, 0.0))


def fastest_way():
    """Return times (N,), s, and places, velocities and accelerations (N, 3) of the way that takes the least time.

    A point mass with limits of speed and acceleration passes the centre of each gate in the direction of the gate.
    """
    problem = casadi.Opti()
    times = problem.variable(len(GATES) + 1)
    count = STEPS * (len(GATES) + 1)
    place, speed = problem.variable(3, count + 1), problem.variable(3, count + 1)
    push = problem.variable(3, count)
    problem.subject_to(place[:, 0] == START)
    problem.subject_to(speed[:, 0] == (0, 0, 0))
    problem.subject_to(speed[:, count] == (0, 0, 0))
    for step in range(count):
        h = times[step // STEPS] / STEPS
        problem.subject_to(place[:, step + 1] == place[:, step] + h * speed[:, step] + h**2 / 2 * push[:, step])
        problem.subject_to(speed[:, step + 1] == speed[:, step] + h * push[:, step])
        problem.subject_to(casadi.sumsqr(push[:, step]) <= STRONGEST**2)
        problem.subject_to(casadi.sumsqr(speed[:, step]) <= FASTEST**2)
    for k, (x, y, z, yaw) in enumerate(GATES):
        ahead, aside = casadi.DM([math.cos(yaw), math.sin(yaw), 0]), casadi.DM([-math.sin(yaw), math.cos(yaw), 0])
        knot = STEPS * (k + 1)
        problem.subject_to(place[:, knot] == (x, y, z))
        problem.subject_to(casadi.dot(aside, speed[:, knot]) == 0)
        problem.subject_to(casadi.dot(ahead, speed[:, knot]) >= 0.5)
        problem.set_initial(place[:, knot], (x, y, z))
        problem.set_initial(speed[:, knot], ahead)
    problem.subject_to(times >= 0.3)
    problem.set_initial(times, 3.0)
    problem.minimize(casadi.sum1(times) + 1e-3 * casadi.sumsqr(push))
    problem.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes"})
    solution = problem.solve()
    lengths = np.repeat(solution.value(times) / STEPS, STEPS)
    pushes = solution.value(push).T
    states = solution.value(place).T, solution.value(speed).T, np.concatenate([pushes, pushes[-1:]])
    return np.concatenate([[0.0], np.cumsum(lengths)]), *states


def command(sim, place, speed, push):
    """Tilt and thrust that accelerate as the way does, and correct errors; the drone does not turn."""
    here, own = sim.drone.pose.data, sim.drone.velocity.data["world_linear_velocity"]
    errors = np.array(place) - [here[axis] for axis in "xyz"]
    x, y, z = np.clip(push + STIFF * errors + DAMPED * (np.array(speed) - own), -7.0, 7.0)
    thrust = MASS * math.hypot(x, y, GRAVITY + z) / THRUST
    sim.drone.pilot.publish(
        {"roll": -math.atan2(y, GRAVITY + z), "pitch": -math.atan2(x, GRAVITY + z), "thrust": thrust}
    )


def fly(sim):
    """Fly the way; return the time, the number of gates passed, the largest error there, and the final one, m."""
    times, *rows = fastest_way()
    contacts, passed, worst = sim.drone.contacts(), 0, 0.0
    before = np.array(START)
    while sim.time() < times[-1] + 2.0 and not contacts.touched:
        command(sim, *([np.interp(sim.time(), times, row[:, axis]) for axis in range(3)] for row in rows))
        sim.step()
        after = np.array([sim.drone.pose.data[axis] for axis in "xyz"])
        if passed < len(GATES):
            x, y, z, yaw = GATES[passed]
            ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
            was, is_now = ahead @ (before - (x, y, z)), ahead @ (after - (x, y, z))
            if was < 0.0 <= is_now:
                there = before + (after - before) * was / (was - is_now)
                miss = float(np.max(np.abs((there - (x, y, z)) @ np.array([[-ahead[1], 0], [ahead[0], 0], [0, 1.0]]))))
                if miss < HALF:
                    passed, worst = passed + 1, max(worst, miss)
        before = after
    return {"time": sim.time(), "passed": passed, "worst": worst, "left": float(np.linalg.norm(before - rows[0][-1]))}


if __name__ == "__main__":
    for wind in (0.0, 3.0):
        with morse.load(partial(scene, wind)) as simulation:
            flown = fly(simulation)
        print(
            "wind {:.0f} m/s: {passed} gates in {time:.1f} s, at most {worst:.2f} m from their centres".format(
                wind, **flown
            )
        )
