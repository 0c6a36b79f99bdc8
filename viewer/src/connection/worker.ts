/* The connection runs in a worker: rendering never delays a key or a heartbeat. */
import { fileAddress } from "./address";
import type { Hello, PageMessage, SceneDescription, ServerMessage } from "../generated/protocol";
import { MAX_MESSAGE, VERSION } from "../generated/protocol";
import { decodePayload, kindOf, POSES, sameBytes } from "./frames";

export type ToWorker =
  | { kind: "open"; url: string; page: string }
  | { kind: "send"; message: PageMessage }
  /** the page is alive and visible */
  | { kind: "pulse" }
  /** the page has drawn the last poses */
  | { kind: "drawn" };

export type FromWorker =
  | { kind: "state"; open: boolean; code: number; reason: string }
  | { kind: "message"; message: ServerMessage }
  | { kind: "poses"; frame: ArrayBuffer };

const BEAT = 150; // ms
const PULSE_LASTS = 1000; // ms: a page that hangs longer counts as closed
const TAKEN_EVERY = 4;
const RETRY = [300, 600, 1000, 2000, 3000];

const scope = self as unknown as { postMessage(message: FromWorker, transfer?: Transferable[]): void; onmessage: unknown };
let socket: WebSocket | null = null;
let url = "";
let pageUrl = "";
let pulse = 0;
let taken = 0;
let failures = 0;
let welcome = false;
let drawing = false;
let prefetched = false;
let newest: ArrayBuffer | null = null;
/** the last poses that came, as they came: the page need not see the same ones again */
let known: ArrayBuffer | null = null;

function send(message: PageMessage): void {
  if (socket?.readyState !== WebSocket.OPEN) return refuse(message, "there is no connection to the simulator");
  const text = JSON.stringify(message);
  // the simulator would close the connection
  const size = 3 * text.length > MAX_MESSAGE ? new TextEncoder().encode(text).length : 0;
  if (size > MAX_MESSAGE) return refuse(message, `this is too long to be sent: ${size >> 10} KiB of at most ${MAX_MESSAGE >> 10}`);
  socket.send(text);
}

/** Answer a request that cannot be sent: whoever waits for its answer goes on. */
function refuse(message: PageMessage, error: string): void {
  if (!("request" in message) || message.type === "cancel_service") return;
  scope.postMessage({ kind: "message", message: { type: "answer", request: message.request, ok: false, value: null, error } });
}

function showNewest(): void {
  if (drawing || newest === null) return;
  drawing = true;
  scope.postMessage({ kind: "poses", frame: newest }, [newest]);
  newest = null;
}

/** While the page initialises its canvas: load what it will fetch next into the browser's cache. */
async function prefetch(world: string): Promise<void> {
  const { meshes } = (await (await fetch(fileAddress(world, pageUrl))).json()) as SceneDescription;
  await Promise.all([...new Set(meshes.map((mesh) => mesh.url))].map((file) => fetch(fileAddress(file, pageUrl))));
}

function receive(data: string | ArrayBuffer): void {
  if (!welcome) {
    // only now: a simulator that turns the page away accepts its connection first
    welcome = true;
    failures = 0;
    scope.postMessage({ kind: "state", open: true, code: 0, reason: "" });
  }
  if (typeof data === "string") {
    const message = JSON.parse(data) as ServerMessage;
    scope.postMessage({ kind: "message", message });
    if (message.type === "world" && !prefetched) {
      prefetched = true;
      prefetch(message.url).catch(() => {}); // the page reports errors
    }
  } else if (kindOf(data) === POSES) {
    taken += 1;
    if (taken % TAKEN_EVERY === 0) send({ type: "taken", count: taken });
    if (known !== null && sameBytes(known, data)) return;
    known = data.slice(0);
    newest = data;
    showNewest();
  } else {
    scope.postMessage({ kind: "message", message: decodePayload(data) });
  }
}

function open(): void {
  socket = new WebSocket(url);
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    welcome = false;
    taken = 0;
    drawing = false;
    newest = null;
    known = null;
    const hello: Hello = { type: "hello", version: VERSION };
    send(hello);
  };
  socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => receive(event.data);
  socket.onclose = (event) => {
    scope.postMessage({ kind: "state", open: false, code: event.code, reason: event.reason });
    setTimeout(open, RETRY[Math.min(failures, RETRY.length - 1)]);
    failures += 1;
  };
}

scope.onmessage = (event: MessageEvent<ToWorker>) => {
  const order = event.data;
  if (order.kind === "open") {
    url = order.url;
    pageUrl = order.page;
    open();
  } else if (order.kind === "send") send(order.message);
  else if (order.kind === "pulse") pulse = performance.now();
  else {
    drawing = false;
    showNewest();
  }
};

setInterval(() => {
  if (performance.now() - pulse < PULSE_LASTS) send({ type: "alive" });
}, BEAT);
