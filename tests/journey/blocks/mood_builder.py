from morse.builder import LedArray

class Mood(LedArray):
    """Shows the mood of the Ranger in coloured lights"""

    _classpath = "ranger_sim.actuators.mood.Mood"

    def __init__(self, name=None):
        LedArray.__init__(self, name, rows=5, columns=7, pitch=0.06)
