"""Ticks: their order, their schedule, their pace, and what they cost."""
