// A client of MORSE in JavaScript: Node 18 or later, without packages.
//
//     node client.mjs        (port 4000, or MORSE_SOCKET_PORT)
//
// The scene has a robot `robot` with an actuator `motion` (MotionVW) and a sensor `pose` (Pose): see docs/socket.md.
// It drives until the pose says 0.5 m, then stops.

import { once } from "node:events";
import { connect } from "node:net";
import { createInterface } from "node:readline";

const HOST = "127.0.0.1";

/** Messages contain Infinity and NaN, which JSON does not have; in text they stay as they are. */
function parse(line) {
  const bare = /"(?:[^"\\]|\\.)*"|-?Infinity|NaN/g;
  return JSON.parse(line.replace(bare, (word) => (word[0] === '"' ? word : "null")));
}

/** A connection that carries lines. */
async function lines(port) {
  const socket = connect(port, HOST);
  await once(socket, "connect");
  socket.setNoDelay(true);
  return { write: (line) => socket.write(`${line}\n`), read: createInterface({ input: socket }), end: () => socket.destroy() };
}

/** Services: a request is `id component service [arguments]`, its answer `id SUCCESS|FAILED|PREEMPTED [result]`. */
class Services {
  static async open(port) {
    const services = new Services();
    services.connection = await lines(port);
    services.waiting = new Map();
    services.last = 0;
    services.connection.read.on("line", (line) => services.answer(line));
    services.connection.read.on("close", () => {
      for (const [, reject] of services.waiting.values()) reject(new Error("the simulation has ended"));
    });
    return services;
  }

  answer(line) {
    const [, id, status, result] = /^(\S+) (\w+) ?(.*)$/.exec(line) ?? [];
    const [resolve, reject] = this.waiting.get(Number(id)) ?? [];
    this.waiting.delete(Number(id));
    if (status === "SUCCESS") resolve?.(result ? parse(result) : null);
    else reject?.(new Error(`${status} ${result}`));
  }

  call(component, service, ...values) {
    const id = ++this.last;
    this.connection.write(`${id} ${component} ${service} ${JSON.stringify(values)}`);
    return new Promise((resolve, reject) => this.waiting.set(id, [resolve, reject]));
  }
}

const simulation = await Services.open(Number(process.env.MORSE_SOCKET_PORT ?? 4000));
const stream = async (name) => lines(await simulation.call("simulation", "get_stream_port", name));
const [motion, pose] = [await stream("robot.motion"), await stream("robot.pose")];

let start = null;
for await (const line of pose.read) {
  const here = parse(line);
  start ??= here;
  const driven = Math.hypot(here.x - start.x, here.y - start.y);
  if (driven >= 0.5) {
    console.log(`driven ${driven.toFixed(3)} m`);
    break;
  }
  motion.write(JSON.stringify({ v: 0.5, w: 0.0 }));
}
// on the same connection: a service may be faster than the last message of a stream
motion.write(JSON.stringify({ v: 0.0, w: 0.0 }));
console.log(`at ${await simulation.call("time", "now")} s`);
for (const one of [simulation.connection, motion, pose]) one.end();
