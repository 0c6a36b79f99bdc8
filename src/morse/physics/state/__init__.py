"""The state of the physics: saved, restored, and transferred to the model of a changed scene."""
