"""The behaviour of components: what every robot, sensor and actuator has in common."""

from morse.core.classes.old_modules import OldModules

OldModules().install()
