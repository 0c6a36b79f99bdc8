"""Backends that transport messages: `morse.middleware.ros2.backends.choice` lists them."""
