"""Lessons: a scene, a task, a program to complete, and a check that says what is right and what is missing.

A lesson is a module, of which these names count:

* its docstring: the title is the first line, the task is the rest, in Markdown;
* ``scene``: a function without arguments that builds the scene, with ``from morse.builder import *`` in its first line;
* ``START``: the program that students complete, as text;
* ``check``: a function that gets an `morse.plugins.lessons.attempt.Attempt` and calls its ``expect``.

A package adds lessons by the entry points of ``morse.lessons``: a module, or a package
with a module for each lesson.
"""
