"""The data of components as messages of an MQTT broker."""
