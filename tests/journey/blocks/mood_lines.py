self.mood = Mood()
self.mood.translate(0.55, 0.0, 0.3)
self.append(self.mood)
