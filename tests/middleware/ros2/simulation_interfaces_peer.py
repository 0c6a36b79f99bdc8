"""The peer: a node of rclpy with clients of simulation_interfaces. It prints what they are answered as JSON."""

from __future__ import annotations

import json
import os
import sys
import time
from typing import Any

os.environ["ROS_DOMAIN_ID"] = sys.argv[1]

import rclpy
from rclpy.action import ActionClient
from simulation_interfaces import srv
from simulation_interfaces.action import SimulateSteps
from simulation_interfaces.msg import EntityFilters, EntityInfo, Result, SimulationState, SimulatorFeatures, TagsFilter

_LIMIT = 90.0
_URDF = (
    '<robot name="rover"><link name="base"><inertial><mass value="5"/></inertial><collision><geometry>'
    '<box size="0.4 0.3 0.2"/></geometry></collision></link></robot>'
)


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("judge")
    end = time.monotonic() + _LIMIT

    def wait(future: Any) -> Any:
        while not future.done() and time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=0.05)
        assert future.done()
        return future.result()

    def call(kind: Any, **fields: Any) -> Any:
        name = "".join(f"_{letter.lower()}" if letter.isupper() else letter for letter in kind.__name__)
        client = node.create_client(kind, f"/morse/{name.lstrip('_')}")
        assert client.wait_for_service(max(1.0, end - time.monotonic())), name
        answer = wait(client.call_async(kind.Request(**fields)))
        node.destroy_client(client)
        return answer

    said: dict[str, Any] = {"features": list(call(srv.GetSimulatorFeatures).features.features)}
    said["spawnables"] = [one.uri for one in call(srv.GetSpawnables).spawnables]
    made = [
        call(srv.SpawnEntity, name="second", uri="ATRV"),
        call(srv.SpawnEntity, uri="props/crates"),
        call(srv.SpawnEntity, name="third", resource_string=_URDF),
        call(srv.SpawnEntity, name="fourth", uri="no_such_thing"),
    ]
    said["spawned"] = [(one.entity_name, one.result.result) for one in made]
    said["entities"] = list(call(srv.GetEntities).entities)
    states = call(srv.GetEntitiesStates)
    said["states"] = len(states.states) == len(states.entities) > 0
    request = srv.SetEntityState.Request(entity="third")
    request.state.pose.position.x, request.state.pose.position.z = 7.0, 1.0
    said["put"] = call(srv.SetEntityState, entity="third", state=request.state).result.result
    said["place"] = call(srv.GetEntityState, entity="third").state.pose.position.x
    said["kind"] = call(srv.GetEntityInfo, entity="third").info.category.category
    bounds = call(srv.GetEntityBounds, entity="third").bounds
    said["size"] = [getattr(bounds.points[0], axis) - getattr(bounds.points[1], axis) for axis in "xyz"]
    info = EntityInfo(description="mine", tags=["blue"])
    said["noted"] = call(srv.SetEntityInfo, entity="third", info=info).result.result
    bounds.points[0].z, bounds.points[1].z = 99.0, -99.0  # it is falling
    filters = EntityFilters(tags=TagsFilter(tags=["blue"]), bounds=bounds)
    said["blue"] = list(call(srv.GetEntities, filters=filters).entities)
    said["poses"] = [(one.name, one.pose.position.x) for one in call(srv.GetNamedPoses).poses]
    said["dock"] = [point.x for point in call(srv.GetNamedPoseBounds, name="dock").bounds.points]
    said["world"] = call(srv.GetCurrentWorld).world.name
    said["worlds"] = [one.world_resource.uri for one in call(srv.GetAvailableWorlds).worlds]
    said["deleted"] = call(srv.DeleteEntity, entity="third").result.result

    steps = ActionClient(node, SimulateSteps, "/morse/simulate_steps")
    assert steps.wait_for_server(max(1.0, end - time.monotonic()))
    progress: list[Any] = []

    def run(number: int) -> Any:
        heard = lambda m: progress.append([m.feedback.completed_steps, m.feedback.remaining_steps])  # noqa: E731
        goal = wait(steps.send_goal_async(SimulateSteps.Goal(steps=number), feedback_callback=heard))
        return wait(goal.get_result_async())

    said["steps of a running one"] = run(5).result.result.result
    paused = SimulationState(state=SimulationState.STATE_PAUSED)
    said["paused"] = call(srv.SetSimulationState, state=paused).result.result
    said["state"] = call(srv.GetSimulationState).state.state
    before = call(srv.GetEntityState, entity="robot").state.header.stamp
    answer = run(120)
    after = call(srv.GetEntityState, entity="robot").state.header.stamp
    said["steps"] = [answer.status, answer.result.result.result]
    said["seconds"] = after.sec - before.sec + (after.nanosec - before.nanosec) * 1e-9
    said["progress"] = progress
    # a goal that would run for ever is cancelled
    goal = wait(steps.send_goal_async(SimulateSteps.Goal(steps=1_000_000)))
    other = wait(steps.send_goal_async(SimulateSteps.Goal(steps=1)))
    said["two at once"] = other.accepted
    said["canceling"] = len(wait(goal.cancel_goal_async()).goals_canceling)
    said["canceled"] = wait(goal.get_result_async()).status
    said["step"] = call(srv.StepSimulation, steps=3).result.result
    said["reset"] = call(srv.ResetSimulation).result.result
    said["constants"] = [Result.RESULT_OK, SimulatorFeatures().features.typecode]
    print(json.dumps(said))
    node.destroy_node()
    rclpy.shutdown()


main()
