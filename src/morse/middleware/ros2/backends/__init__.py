"""What carries the bytes of messages: `morse.middleware.ros2.backends.choice` says which backends there are."""
