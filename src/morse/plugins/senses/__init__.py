"""Radar, sonar, Doppler logs, event cameras and other senses that few simulations need."""
