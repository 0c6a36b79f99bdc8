import type { ServerMessage } from "../generated/protocol";

/** The poses of all moving nodes at the end of a tick. */
export interface PoseFrame {
  revision: number;
  running: boolean;
  tick: number;
  /** simulated seconds */
  time: number;
  /** requested simulated seconds per wall-clock second; infinite: as fast as possible */
  speed: number;
  /** reached simulated seconds per wall-clock second */
  realTimeFactor: number;
  /** x, y, z, qw, qx, qy, qz of each node */
  poses: Float32Array;
}

export const POSES = 1;
const PAYLOAD = 2;
export const HEADER = 40;

export function kindOf(frame: ArrayBuffer): number {
  return new DataView(frame).getUint32(0, true);
}

export function decodePoses(frame: ArrayBuffer): PoseFrame {
  const view = new DataView(frame);
  return {
    revision: view.getUint32(4, true),
    running: view.getUint32(12, true) !== 0,
    tick: view.getFloat64(16, true),
    time: view.getFloat64(24, true),
    speed: view.getFloat32(32, true),
    realTimeFactor: view.getFloat32(36, true),
    poses: new Float32Array(frame, HEADER, view.getUint32(8, true) * 7),
  };
}

/** Whether the poses of two frames are equal. */
export function samePoses(a: PoseFrame, b: PoseFrame): boolean {
  return a.revision === b.revision && a.poses.length === b.poses.length && a.poses.every((number, i) => number === b.poses[i]);
}

/** Whether two frames are equal in everything: a simulation that is paused repeats its last one. */
export function sameBytes(a: ArrayBuffer, b: ArrayBuffer): boolean {
  if (a.byteLength !== b.byteLength) return false;
  const [one, other] = [new Uint8Array(a), new Uint8Array(b)];
  return one.every((byte, i) => byte === other[i]);
}

/** A message with a payload. */
export function decodePayload(frame: ArrayBuffer): ServerMessage {
  const view = new DataView(frame);
  if (view.getUint32(0, true) !== PAYLOAD) throw new Error("a binary frame of an unknown kind");
  const length = view.getUint32(4, true);
  const message = JSON.parse(new TextDecoder().decode(new Uint8Array(frame, 8, length))) as ServerMessage;
  return { ...message, payload: frame.slice(8 + length) } as ServerMessage;
}
