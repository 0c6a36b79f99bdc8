"""How wrong is the simulation for this robot? Compares a scene with a log, and fits its parameters.

::

    from morse.many import Twin

    twin = Twin("drive.mcap", "scene.py", fit=["wheel_radius", "imu.bias"])
    fitted = twin.fit(workers=2)
    print(fitted)
    fitted.write("results")

See ``docs/twin.md``.
"""
