"""A layout of Foxglove for the topics of a scene, in the form that `foxglove.layouts` of its SDK writes."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from morse.core.values import JsonObject

_IMAGE, _INFO = "sensor_msgs/msg/Image", "sensor_msgs/msg/CameraInfo"
_ODOMETRY, _FIX = "nav_msgs/msg/Odometry", "sensor_msgs/msg/NavSatFix"
_TWISTS = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
#: what the panel of three dimensions shows, besides descriptions of robots
_SHOWN = (
    *("sensor_msgs/msg/LaserScan", "sensor_msgs/msg/PointCloud2", "geometry_msgs/msg/PoseStamped"),
    *("visualization_msgs/msg/MarkerArray", "nav_msgs/msg/Path"),
)
_MOST_IMAGES, _MOST_TELEOPS = 4, 2


def layout_of(published: Mapping[str, str], heard: Mapping[str, str] | None = None) -> JsonObject:
    """A layout as JSON: three dimensions and images, beside plots, panels that drive, parameters, diagnostics.

    Args:
        published: topics to types of messages.
        heard: topics for commands to types of messages; None for a recording, which takes none.
    """
    views = [_three_dimensions(published), *_images(published)[:_MOST_IMAGES]]
    tools = [_plot(published)] if _ODOMETRY in published.values() else []
    if _FIX in published.values():
        tools.append(_panel("Map", {"followTopic": _first(published, _FIX)}))
    driving = [name for name, kind in (heard or {}).items() if kind in _TWISTS and name.endswith("cmd_vel")]
    tools += [_teleop(name) for name in sorted(driving)[:_MOST_TELEOPS]]
    tabs = [("Messages", _panel("DataSourceInfo", {}))] if heard is None else [("Parameters", _panel("Parameters", {}))]
    if "/diagnostics" in published:
        tabs.append(("Diagnostics", _panel("DiagnosticsSummary", {"topicToRender": "/diagnostics"})))
    if "/rosout" in published:
        tabs.append(("Log", _panel("Log", {"topicToRender": "/rosout"})))
    if heard is not None:
        tabs.append(("Graph", _panel("TopicGraph", {})))
    contents = [{"title": title, "content": content} for title, content in tabs]
    tools.append({"type": "tabs", "selectedTabIndex": 0, "tabs": contents})
    content = _split("row", [(2.0, _split("column", [(1.0, one) for one in views])), (1.0, _column(tools))])
    return {"version": 1, "content": content}


def _first(topics: Mapping[str, str], kind: str) -> str:
    return min(name for name, one in topics.items() if one == kind)


def _panel(kind: str, config: JsonObject) -> JsonObject:
    return {"type": "panel", "panelType": kind, "config": config, "version": 1}


def _split(direction: str, items: list[tuple[float, JsonObject]]) -> JsonObject:
    contents = [{"proportion": proportion, "content": content} for proportion, content in items]
    return {"type": "split", "direction": direction, "items": contents}


def _column(panels: list[JsonObject]) -> JsonObject:
    return _split("column", [(1.0, one) for one in panels])


def _three_dimensions(types: Mapping[str, str]) -> JsonObject:
    models = [name for name in types if name.rpartition("/")[2] == "robot_description"]
    visible = [name for name, kind in types.items() if kind in _SHOWN]
    topics = {name: {"visible": True} for name in sorted([*models, *visible])}
    grid = {"layerId": "foxglove.Grid", "instanceId": "grid", "visible": True, "size": 20, "divisions": 20}
    config: JsonObject = {"fixedFrame": "map", "followMode": "follow-none", "layers": {"grid": grid}, "topics": topics}
    return _panel("ThreeDee", config)


def _images(topics: Mapping[str, str]) -> list[JsonObject]:
    panels = []
    for name in sorted(name for name, kind in topics.items() if kind == _IMAGE):
        mode = {"imageTopic": name}
        info = f"{name.rpartition('/')[0]}/camera_info"
        if topics.get(info) == _INFO:
            mode["calibrationTopic"] = info
        panels.append(_panel("Image", {"imageMode": mode}))
    return panels


def _plot(topics: Mapping[str, str]) -> JsonObject:
    topic = _first(topics, _ODOMETRY)
    fields = ("twist.twist.linear.x", "twist.twist.angular.z")
    paths = [{"value": f"{topic}.{field}", "timestampMethod": "headerStamp", "enabled": True} for field in fields]
    return _panel("Plot", {"paths": paths})


def _teleop(topic: str) -> JsonObject:
    buttons = {
        "upButton": {"field": "linear-x", "value": 0.5},
        "downButton": {"field": "linear-x", "value": -0.5},
        "leftButton": {"field": "angular-z", "value": 0.5},
        "rightButton": {"field": "angular-z", "value": -0.5},
    }
    return _panel("Teleop", {"topic": topic, "publishRate": 10.0, **buttons})
