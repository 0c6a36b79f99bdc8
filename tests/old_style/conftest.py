"""The files of this folder are tests in the style of MORSE 1.4, each of which is a program."""

collect_ignore_glob = ["*_testing.py"]
