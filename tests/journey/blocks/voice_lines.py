voice = Sound()
voice.open('ranger_sim/data/ranger_sim/beep.wav')
robot.append(voice)
