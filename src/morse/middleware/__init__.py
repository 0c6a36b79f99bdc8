"""The ways in which robot controllers reach the simulation."""
