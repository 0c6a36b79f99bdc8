"""Objects that one ray finds, as the semantic camera of MORSE 1.4 does."""

import pytest

SCRIPT = """
def solid(name, location, half, **tags):
    cube = Cube(name); cube.scale = half; cube.location = location
    cube._bpy_object.game.physics_type = "STATIC"
    cube.properties(**tags)
robot = FakeRobot("robot"); robot.translate(z=10)
ray = {{"visibility": "ray"}}
for name, more in (("ray", ray), ("pixels", {{}}), ("all", {{"noocclusion": True, **ray}})):
    eye = SemanticCamera(name); eye.properties(cam_width=64, cam_height=64, cam_focal=16, **more); robot.append(eye)
    {each}
# its origin is behind a post, which hides a tenth of it
solid("Wide", (6, 0, 10), (0.2, 2, 1), Object=True)
solid("Post", (3, 0, 10), (0.1, 0.1, 3))
solid("Near", (2, 1, 10), (0.2, 0.2, 0.2), Object=True)
# its upper end alone is in the field of view, whose half is 45 degrees
solid("Low", (4, -2, 5), (0.2, 0.2, 1.5), Object=True)
solid("Outside", (4, 9, 10), (0.2, 0.2, 0.2), Object=True)
soft = Cube("Soft"); soft.scale = (0.2, 0.2, 0.2); soft.location = (3, 2, 10); soft.properties(Object=True)
env = Environment("empty")
"""


@pytest.fixture
def names(simulate):
    def make(each=""):
        simulation = simulate(SCRIPT.format(each=each), sockets=False)
        simulation.sleep(0.2)
        found = {
            eye: simulation.context.component(f"robot.{eye}").local_data["visible_objects"]
            for eye in ("ray", "pixels", "all")
        }
        return {eye: {seen["name"] for seen in things} for eye, things in found.items()}

    return make


@pytest.mark.parametrize("each", ["", "eye.delay(0.05)"])
def test_a_ray_decides_what_pixels_decide_otherwise(names, each):
    seen = names(each)
    assert seen["pixels"] == {"Wide", "Near", "Low", "Soft"}
    # the ray to the origin of the wide object hits the post; nothing stops it at an object without collision
    assert seen["ray"] == {"Near", "Low"}
    assert seen["all"] == {"Wide", "Near", "Low", "Soft"}
