"""Walks to the table, takes the cup, carries it back, and raises the left hand."""

from pymorse import Morse


def place_of(simu, name):
    """The position of an object, m."""
    return simu.rpc("simulation", "get_scene_objects")[name][1]


def main():
    """Returns whether the cup was taken, its way, m, and the angles of the joints, rad."""
    with Morse() as simu:
        person, before = simu.person, place_of(simu, "cup")

        person.walk.goto(2.6, 0.0, 0.0, 0.1, 1.0).result()
        taken = person.grasp(True, "cup").result()
        person.walk.goto(0.0, 0.0, 0.0, 0.3, 1.0).result()

        # the target of the left wrist, 0.6 m up in one second; the joints follow
        target = "ik_target.person.skeleton.wrist_L"
        person.skeleton.move_IK_target(target, [0.1, 0.1, 0.6], None, True, 0.6).result()
        joints = person.skeleton.joint_states.get()

        person.grasp(False).result()
        return taken, before[0] - place_of(simu, "cup")[0], joints


if __name__ == "__main__":
    taken, way, joints = main()
    print("Took the cup: %s. It was carried %.1f m." % (taken, way))
    print("The left shoulder is at %.2f rad." % joints["shoulder01_L"])
