"""What components hold of the physics: objects, wheels, joints, and what is attached or locked."""
