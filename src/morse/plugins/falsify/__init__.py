"""Searches for the smallest parameters with which the software of a robot violates what has to hold.

::

    from morse.many import Scenario, uniform

    scenario = Scenario("crossing.py", run, speed=uniform(0.2, 1.5), seed=range(100))
    scenario.always("nearest > 0.4")
    found = scenario.falsify("results", budget=600, workers=2)

See ``docs/falsify.md``.
"""
