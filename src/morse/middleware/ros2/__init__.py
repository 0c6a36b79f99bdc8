"""Components as ROS 2 topics, with rclpy or, without any ROS installation, with Cyclone DDS."""
