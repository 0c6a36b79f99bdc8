import type { PageMessage, ServerMessage } from "../generated/protocol";
import { HEADER, POSES } from "./frames";
import type { PoseTrack, Tape } from "./tape";
import { lastAt } from "./tape";
import type { FromWorker, ToWorker } from "./worker";

/** Values that were passed while the page drew a frame are all delivered, for plots; at most that many. */
const MOST_PASSED = 100;
/** Between two poses that are further apart, m, a node was moved, not driven. */
const LEAP = 1;

/** Plays a tape: it takes the place of the worker that is connected to a simulator. */
export class Player {
  onmessage: ((event: MessageEvent<FromWorker>) => void) | null = null;
  private now = 0;
  private speed = 1;
  private direction = 1;
  private shown = -1;
  private last = 0;
  /** whether the page is in sight: a frame below the end of a window plays to nobody */
  private inSight = true;
  private readonly delivered = new Map<string, number>();

  constructor(private readonly run: Promise<Tape>) {}

  postMessage(order: ToWorker): void {
    if (order.kind === "open") void this.run.then((tape) => this.begin(tape));
    else if (order.kind === "send") void this.run.then((tape) => this.obey(order.message, tape));
  }

  terminate(): void {
    this.onmessage = null;
  }

  private begin(tape: Tape): void {
    this.now = tape.begin;
    this.tell({ kind: "state", open: true, code: 0, reason: "" });
    const frame = (time: number): void => {
      const seconds = Math.min((time - this.last) / 1000, 0.5);
      this.last = time;
      if (this.inSight || this.shown < 0) this.go(tape, this.now + this.direction * this.speed * seconds);
      requestAnimationFrame(frame);
    };
    new IntersectionObserver((seen) => (this.inSight = seen.at(-1)?.isIntersecting ?? true)).observe(document.documentElement);
    this.last = performance.now();
    this.go(tape, tape.begin);
    requestAnimationFrame(frame);
  }

  private obey(message: PageMessage, tape: Tape): void {
    const step = 1 / tape.frequency;
    if (message.type === "play") this.play(tape, 1);
    else if (message.type === "play_backward") this.play(tape, -1);
    else if (message.type === "pause") this.play(tape, 0);
    else if (message.type === "step") this.go(tape, this.now + step * (message.count ?? 1));
    else if (message.type === "step_back") this.go(tape, this.now - step);
    else if (message.type === "rewind") this.go(tape, message.time);
    else if (message.type === "reset") this.go(tape, tape.begin);
    else if (message.type === "set_speed") this.speed = message.factor ?? 10;
    else if ("request" in message) {
      const { request } = message;
      this.deliver({ type: "answer", request, ok: false, value: null, error: "a recorded run cannot be changed" });
      return;
    }
    this.shown = -1;
  }

  private play(tape: Tape, direction: number): void {
    if (direction > 0 && this.now >= tape.end) this.go(tape, tape.begin);
    this.direction = direction;
  }

  /** Show a moment of the run. */
  private go(tape: Tape, time: number): void {
    this.now = Math.max(tape.begin, Math.min(time, tape.end));
    if ((time >= tape.end && this.direction > 0) || (time <= tape.begin && this.direction < 0)) {
      if (location.hash === "#loop" && this.direction > 0) this.now = tape.begin;
      else this.direction = 0;
      this.shown = -1;
    }
    if (this.now === this.shown) return;
    this.shown = this.now;
    for (const [subject, { times, messages }] of tape.tracks) {
      const at = lastAt(times, this.now);
      const before = this.delivered.get(subject) ?? -1;
      if (at === before || at < 0) continue;
      this.delivered.set(subject, at);
      const passed = messages[at]?.type === "values" && at > before && at - before < MOST_PASSED;
      for (const message of messages.slice(passed ? before + 1 : at, at + 1)) this.deliver(message);
    }
    const track = tape.poses.filter(({ times }) => (times[0] as number) <= this.now + 1e-6).at(-1);
    if (track) this.tell({ kind: "poses", frame: this.frame(track, tape) });
  }

  private frame(track: PoseTrack, tape: Tape): ArrayBuffer {
    const frame = new ArrayBuffer(HEADER + track.width * 4);
    const view = new DataView(frame);
    view.setUint32(0, POSES, true);
    view.setUint32(4, track.revision, true);
    view.setUint32(8, track.width / 7, true);
    view.setUint32(12, this.direction === 0 ? 0 : 1, true);
    view.setFloat64(16, Math.round(this.now * tape.frequency), true);
    view.setFloat64(24, this.now, true);
    view.setFloat32(32, this.speed, true);
    view.setFloat32(36, this.speed, true);
    new Float32Array(frame, HEADER).set(between(track, this.now));
    return frame;
  }

  private deliver(message: ServerMessage): void {
    this.tell({ kind: "message", message });
  }

  private tell(data: FromWorker): void {
    this.onmessage?.({ data } as MessageEvent<FromWorker>);
  }
}

/** The poses at a time, interpolated. */
export function between({ times, width, rows }: PoseTrack, time: number): Float32Array {
  const at = Math.max(lastAt(times, time), 0);
  const poses = rows.slice(at * width, (at + 1) * width);
  if (at + 1 >= times.length) return poses;
  const next = rows.subarray((at + 1) * width, (at + 2) * width);
  const [from, to] = [times[at] as number, times[at + 1] as number];
  const share = Math.max(0, Math.min(1, (time - from) / (to - from)));
  for (let node = 0; node < width; node += 7) {
    const part = (list: Float32Array, i: number): number => list[node + i] as number;
    if (Math.hypot(part(next, 0) - part(poses, 0), part(next, 1) - part(poses, 1), part(next, 2) - part(poses, 2)) > LEAP) continue;
    // both signs of a quaternion are the same rotation
    let same = 0;
    for (let i = 3; i < 7; i++) same += part(poses, i) * part(next, i);
    for (let i = 0; i < 7; i++) {
      const target = i > 2 && same < 0 ? -part(next, i) : part(next, i);
      poses[node + i] = part(poses, i) + share * (target - part(poses, i));
    }
    const length = Math.hypot(part(poses, 3), part(poses, 4), part(poses, 5), part(poses, 6)) || 1;
    for (let i = 3; i < 7; i++) poses[node + i] = part(poses, i) / length;
  }
  return poses;
}
