"""Moves each robot radially to the circle, and away from its nearest neighbour along the circle."""

import math

from pymorse import Morse

RADIUS, SECONDS = 4.0, 12.0  # m, s


def main():
    """Returns the distance of each robot from the centre, m, and the gaps along the circle, rad."""
    with Morse() as simu:
        simu.pause()  # all robots use poses of the same tick
        bots = [simu[name] for name in sorted(simu.robots)]
        for bot in bots:
            bot.pose.last()
        for _ in range(round(SECONDS * 10)):
            simu.step(6)
            places = [bot.pose.last() for bot in bots]
            angles = [math.atan2(place["y"], place["x"]) for place in places]
            for bot, place, angle in zip(bots, places, angles):
                ahead = min(((other - angle) % math.tau) or math.tau for other in angles)
                behind = min(((angle - other) % math.tau) or math.tau for other in angles)
                out = RADIUS - math.hypot(place["x"], place["y"])
                along = RADIUS * 0.5 * (ahead - behind)
                bot.motion.publish(
                    {
                        "x": max(-1.0, min(1.0, out)) * math.cos(angle) - max(-1.0, min(1.0, along)) * math.sin(angle),
                        "y": max(-1.0, min(1.0, out)) * math.sin(angle) + max(-1.0, min(1.0, along)) * math.cos(angle),
                        "w": 0.0,
                    }
                )
        places = [bot.pose.last() for bot in bots]
        simu.resume()
    angles = sorted(math.atan2(place["y"], place["x"]) for place in places)
    gaps = [(after - before) % math.tau for before, after in zip(angles, angles[1:] + angles[:1])]
    return [math.hypot(place["x"], place["y"]) for place in places], gaps


if __name__ == "__main__":
    radii, gaps = main()
    print("Radii from %.2f to %.2f m, gaps from %.2f to %.2f rad." % (min(radii), max(radii), min(gaps), max(gaps)))
