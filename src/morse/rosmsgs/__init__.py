"""Messages of ROS: definitions, encoding, and the message of each kind of data. No transport."""
