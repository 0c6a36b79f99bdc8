"""What the tags of Gazebo, ROS and ros2_control in URDF and SDF files stand for here."""
