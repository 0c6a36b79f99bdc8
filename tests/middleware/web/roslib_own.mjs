// roslib.js with its default settings, and with each compression; prints what arrived as JSON.
import { pathToFileURL } from "node:url";

const ROSLIB = await import(pathToFileURL(`${process.argv[2]}/node_modules/roslib/dist/RosLib.js`).href);
const port = process.argv[3];

const ros = new ROSLIB.Ros({ url: `ws://127.0.0.1:${port}` });
await new Promise((resolve, reject) => {
  ros.on("connection", resolve);
  ros.on("error", reject);
});
ros.authenticate?.("mac", "client", "dest", "rand", 0, "admin", 0);
ros.setStatusLevel?.("warning", "level");

const plain = (value) =>
  JSON.parse(
    JSON.stringify(value, (_, v) => {
      if (ArrayBuffer.isView(v)) return { kind: v.constructor.name, items: Array.from(v, Number).slice(0, 1200) };
      if (typeof v === "bigint") return Number(v);
      if (typeof v === "number" && !Number.isFinite(v)) return String(v);
      return v;
    }),
  );
const first = (name, messageType, compression) =>
  new Promise((resolve) => {
    const topic = new ROSLIB.Topic({ ros, name, messageType, ...(compression ? { compression } : {}) });
    topic.subscribe((message) => {
      topic.unsubscribe();
      resolve(plain(message));
    });
  });

const seen = {};
for (const compression of ["", "png", "cbor", "cbor-raw"]) {
  seen[compression || "default"] = {
    scan: await first("/robot/scan", "sensor_msgs/LaserScan", compression),
    odometry: await first("/robot/odometry", "nav_msgs/msg/Odometry", compression),
  };
}
seen.image = await first("/robot/camera/image", "sensor_msgs/Image", "cbor");
seen.topics = (await new Promise((resolve, reject) => ros.getTopics(resolve, reject))).topics;
const service = new ROSLIB.Service({ ros, name: "/robot/motion/set_speed", serviceType: "" });
seen.answer = await new Promise((resolve, reject) => service.callService({ v: 0.5, w: 0.0 }, resolve, reject));
seen.refused = await new Promise((resolve) => service.callService({ fast: 1 }, () => resolve(""), resolve));
const wheels = new ROSLIB.Topic({ ros, name: "/robot/cmd_vel", messageType: "geometry_msgs/Twist" });
wheels.publish({ linear: { x: 0.4, y: 0, z: 0 }, angular: { x: 0, y: 0, z: 0 } });
seen.speed = await new Promise((resolve) => {
  const topic = new ROSLIB.Topic({ ros, name: "/robot/odometry", messageType: "nav_msgs/Odometry" });
  topic.subscribe((message) => {
    const speed = message.twist.twist.linear.x;
    if (speed > 0.35 && speed < 0.45) resolve(speed);
  });
});
console.log(JSON.stringify(seen));
process.exit(0);
