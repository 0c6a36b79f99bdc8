"""Descriptions of robots and objects that functions of a program have spawned: plain data, no program."""
