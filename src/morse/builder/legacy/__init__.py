"""What exists only for scene scripts that were written for MORSE 1.4 and for the Python of its time.

New scripts need nothing of this package. Each file serves one kind of old code, and one line of the log says how that
is written today.
"""
