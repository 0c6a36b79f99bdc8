from pymorse import Morse

with Morse() as simu:

    mood = simu.robot.mood
    voice = simu.robot.voice

    voice.publish({"mode": "play"})
    mood.show("happy").result()

    mood.blink(0.5)
    mood.show("sad").result()

    voice.publish({"mode": "stop"})
    print("The moods of the Ranger are over")
