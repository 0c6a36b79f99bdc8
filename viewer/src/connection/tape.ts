import { fileAddress } from "./address";
import type { ServerMessage } from "../generated/protocol";

/** Largest size of a run in a page, unpacked, bytes. */
const LARGEST = 2 ** 29;

type Place = [begin: number, length: number];

/** See `morse.viewer.exported_page`. */
interface Head {
  title: string;
  begin: number;
  end: number;
  frequency: number;
  /** unit of the stored poses */
  places: number;
  poses: { revision: number; times: number[]; width: number; begin: number }[];
  files: Record<string, [mime: string, begin: number, length: number]>;
  messages: [time: number, subject: string, message: ServerMessage, payload: Place | null][];
}

/** The poses of one world at some times. */
export interface PoseTrack {
  revision: number;
  times: number[];
  width: number;
  rows: Float32Array;
}

/** The messages about one subject, in the order of time: the last one before a time holds. */
export interface Track {
  times: number[];
  messages: ServerMessage[];
}

/** A recorded run that is part of the page. */
export interface Tape {
  begin: number;
  end: number;
  frequency: number;
  poses: PoseTrack[];
  tracks: Map<string, Track>;
  files: Map<string, Blob>;
}

const element = document.getElementById("tape");

/** The run in this page; null for a page that a simulator serves. */
export const tape: Promise<Tape> | null = element === null ? null : unpack(element.textContent ?? "");
element?.remove();

/** Fetch a file of the simulator, or take it from the tape. */
export async function fetchFile(url: string): Promise<Response> {
  if (tape === null) return fetch(fileAddress(url, location.href));
  const file = (await tape).files.get(url);
  return new Response(file ?? null, { status: file ? 200 : 404, statusText: file ? "" : "Not Found" });
}

/** An address for elements that load a file themselves. */
export async function addressOf(url: string): Promise<string> {
  const file = tape === null ? null : (await tape).files.get(url);
  return file ? URL.createObjectURL(file) : fileAddress(url, location.href);
}

/** Read a tape from the text of the page that contains it. */
export async function unpack(text: string): Promise<Tape> {
  const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const plain = await inflated(packed);
  const size = new DataView(plain).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(plain, 4, size))) as Head;
  const parts = plain.slice(4 + size);
  const files = Object.entries(head.files).map(([url, [mime, begin, length]]): [string, Blob] => [
    url,
    new Blob([parts.slice(begin, begin + length)], { type: mime }),
  ]);
  const tracks = new Map<string, Track>();
  for (const [time, subject, message, payload] of head.messages) {
    const track = tracks.get(subject) ?? { times: [], messages: [] };
    tracks.set(subject, track);
    track.times.push(time);
    const bytes = payload ? { payload: parts.slice(payload[0], payload[0] + payload[1]) } : {};
    track.messages.push({ ...message, ...bytes } as ServerMessage);
  }
  const poses = head.poses.map(({ revision, times, width, begin }) => ({
    revision,
    times,
    width,
    rows: unwind(new Uint8Array(parts, begin, times.length * width * 4), width, head.places),
  }));
  return { begin: head.begin, end: head.end, frequency: head.frequency, poses, tracks, files: new Map(files) };
}

/** Bytes that gzip has packed: not more than a run in a page may have, whatever a file of somebody says. */
async function inflated(packed: Uint8Array<ArrayBuffer>): Promise<ArrayBuffer> {
  const reader = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip")).getReader();
  const chunks: Uint8Array<ArrayBuffer>[] = [];
  let size = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) return new Blob(chunks).arrayBuffer();
    chunks.push(value);
    size += value.length;
    if (size > LARGEST) {
      await reader.cancel();
      throw new Error(`it has more than ${LARGEST >> 20} MB`);
    }
  }
}

/** The numbers of rows of which the differences are stored, the bytes of each weight together. */
function unwind(bytes: Uint8Array, width: number, places: number): Float32Array {
  const count = bytes.length / 4;
  const sums = new Int32Array(width);
  const rows = new Float32Array(count);
  for (let i = 0; i < count; i++) {
    const step =
      (bytes[i] as number) |
      ((bytes[i + count] as number) << 8) |
      ((bytes[i + 2 * count] as number) << 16) |
      ((bytes[i + 3 * count] as number) << 24);
    const column = i % width;
    sums[column] = (sums[column] as number) + step;
    rows[i] = (sums[column] as number) * places;
  }
  return rows;
}

/** Index of the last time that is not later, or -1. */
export function lastAt(times: number[], time: number): number {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((times[middle] as number) <= time + 1e-6) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
