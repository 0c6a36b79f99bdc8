import math
import struct
import wave

RATE = 22050

with wave.open("ranger_sim/data/ranger_sim/beep.wav", "wb") as file:
    file.setnchannels(1)
    file.setsampwidth(2)
    file.setframerate(RATE)
    for i in range(RATE // 2):
        file.writeframes(struct.pack("<h", int(9000 * math.sin(2 * math.pi * 880 * i / RATE))))
