"""From a scene to a model of the engine: bodies, shapes, joints, motors, and what stands wrong at the start."""
