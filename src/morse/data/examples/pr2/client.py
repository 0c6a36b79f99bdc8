"""Raises the torso, spreads the arms, turns the head, drives sideways, and reads the joints."""

from pymorse import Morse


def main():
    """Returns the height of the torso, m, all joint values, rad or m, and the position of the robot, m."""
    with Morse() as simu:
        pr2 = simu.pr2
        pr2.set_torso(0.2).result()

        turns = [
            pr2.l_arm.rotate_joints({"l_shoulder_pan_joint": 1.2, "l_elbow_flex_joint": -0.6}),
            pr2.r_arm.rotate_joints({"r_shoulder_pan_joint": -1.2, "r_elbow_flex_joint": -0.6}),
            pr2.head.rotate("head_pan_joint", 0.5),
        ]
        for turn in turns:
            turn.result()

        # forward, to the left, and a turn: the base moves in all directions
        pr2.motion.publish({"x": 0.0, "y": 0.5, "w": 0.0})
        simu.sleep(2.0)
        pr2.motion.publish({"x": 0.0, "y": 0.0, "w": 0.0})
        simu.sleep(0.5)

        pose = pr2.pose.get()
        return pr2.get_torso().result(), pr2.joint_state.get(), (pose["x"], pose["y"])


if __name__ == "__main__":
    torso, joints, place = main()
    print("The torso is at %.2f m, the robot at (%.1f, %.1f)." % (torso, *place))
    print("Of its %d joints, the left shoulder is at %.2f rad." % (len(joints) - 1, joints["l_shoulder_pan_joint"]))
