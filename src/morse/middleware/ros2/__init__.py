"""Components as ROS 2 topics, with rclpy, or with Cyclone DDS without a ROS installation."""
