"""Robots, components and services for programs that run a simulation in their own process."""
