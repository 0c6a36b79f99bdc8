self.eyes = Eyes()
self.append(self.eyes)
