voice = Sound()
voice.open('ranger_sim/beep.wav')
robot.append(voice)
