// Foxglove's own client library, as its application uses it: a description with its meshes, parameters, the graph.
// Arguments: port of the server, folder with node_modules. Prints what it has seen as JSON.
import { createRequire } from "node:module";

const require = createRequire(`${process.argv[3]}/`);
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const WebSocket = require("ws");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const socket = new WebSocket(`ws://127.0.0.1:${process.argv[2]}`, [FoxgloveClient.SUPPORTED_SUBPROTOCOL, "foxglove.sdk.v1"]);
const client = new FoxgloveClient({ ws: socket });
const seen = { statuses: [], graph: { publishedTopics: {}, subscribedTopics: {}, advertisedServices: {} }, assets: {} };
const channels = new Map();
const wanted = {};
const names = { 71: "mesh", 72: "texture", 73: "secret", 74: "outside" };

function check() {
  const graph = seen.graph;
  const isReader = (graph.subscribedTopics["/rover/robot_description"] ?? []).some((id) => id.startsWith("client"));
  const isWriter = (graph.publishedTopics["/rover/cmd_vel"] ?? []).some((id) => id.startsWith("client"));
  if (isReader && isWriter && seen.changed && seen.refused && seen.all && Object.keys(seen.assets).length === 4) {
    console.log(JSON.stringify(seen));
    process.exit(0);
  }
}

client.on("open", () => {
  client.subscribeConnectionGraph();
  client.getParameters([], "all");
  client.subscribeParameterUpdates(["rover.motion.ControlType"]);
  client.advertise({ topic: "/rover/cmd_vel", encoding: "json", schemaName: "geometry_msgs/msg/Twist" });
});
client.on("serverInfo", (info) => (seen.capabilities = info.capabilities));
client.on("advertise", (all) => {
  for (const channel of all) {
    channels.set(channel.id, channel);
    if (channel.topic === "/rover/robot_description") {
      wanted[client.subscribe(channel.id)] = new MessageReader(parse(channel.schema, { ros2: true }));
    }
  }
});
client.on("message", ({ subscriptionId, data }) => {
  seen.description = wanted[subscriptionId].readMessage(data).data;
  const mesh = /filename="([^"]*)"/.exec(seen.description)[1];
  seen.mesh = mesh;
  client.fetchAsset(mesh, 71);
  client.fetchAsset(new URL("../textures/red.png", mesh.replace("package://", "http://")).href.replace("http://", "package://"), 72);
  client.fetchAsset("file:///etc/passwd", 73);
  client.fetchAsset(mesh.replace(/meshes.*/, "../../outside.png"), 74);
});
client.on("fetchAssetResponse", (response) => {
  const data = response.status === 0 ? Buffer.from(response.data.buffer, response.data.byteOffset, response.data.byteLength) : undefined;
  seen.assets[names[response.requestId]] = data ? data.toString("base64") : { error: response.error };
  check();
});
client.on("parameterValues", ({ parameters, id }) => {
  if (id === "all") {
    seen.all = parameters;
    client.setParameters([{ name: "rover.motion.ControlType", value: "Position" }, { name: "rover.motion.ControlType", value: 3 }], "set");
  } else if (id === "set") {
    seen.set = parameters;
  } else {
    seen.changed = parameters;
  }
  check();
});
client.on("status", ({ level, message }) => {
  seen.statuses.push([level, message]);
  seen.refused = true;
  check();
});
client.on("connectionGraphUpdate", (update) => {
  for (const [table, ids] of [["publishedTopics", "publisherIds"], ["subscribedTopics", "subscriberIds"], ["advertisedServices", "providerIds"]]) {
    for (const entry of update[table]) seen.graph[table][entry.name] = entry[ids];
  }
  check();
});
client.on("error", (error) => {
  console.error(error);
  process.exit(1);
});
