"""ROS 1: topics, services and actions by rospy."""
