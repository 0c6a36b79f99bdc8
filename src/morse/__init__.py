"""MORSE, the Modular OpenRobots Simulation Engine."""
