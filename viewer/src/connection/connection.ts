import type { Answer, PageMessage, ServerMessage } from "../generated/protocol";
import { Signal } from "../ui/signal";
import type { PoseFrame } from "./frames";
import { decodePoses } from "./frames";
import { Player } from "./player";
import { tape } from "./tape";
import type { FromWorker, ToWorker } from "./worker";

export interface LinkState {
  open: boolean;
  code: number;
  reason: string;
}

type Kind = ServerMessage["type"];
type Of<K extends Kind> = Extract<ServerMessage, { type: K }>;
type Request = Extract<PageMessage, { request: number }>;
type WithoutNumber<T> = T extends unknown ? Omit<T, "request"> : never;

/** The connection to the simulator: typed messages in both directions. */
export class Connection {
  readonly state = new Signal<LinkState>({ open: false, code: 0, reason: "" });
  private readonly worker = tape ? new Player(tape) : new Worker(new URL("./worker.ts", import.meta.url), { type: "module" });
  private readonly handlers = new Map<Kind, ((message: ServerMessage) => void)[]>();
  private readonly waiting = new Map<number, (answer: Answer) => void>();
  private requests = 0;
  onPoses: (frame: PoseFrame) => void = () => {};

  open(): void {
    this.worker.onmessage = (event: MessageEvent<FromWorker>) => this.receive(event.data);
    this.on("answer", (answer) => {
      this.waiting.get(answer.request)?.(answer);
      this.waiting.delete(answer.request);
    });
    const url = new URL("ws", location.href);
    url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    url.hash = "";
    this.order({ kind: "open", url: url.href, page: location.href });
    setInterval(() => this.pulse(), 250);
    this.pulse();
    if (tape) return;
    // a browser keeps a page that one has left, with its socket, and may show it again: it would drive on, unseen
    addEventListener("pagehide", () => this.close());
    addEventListener("pageshow", ({ persisted }) => persisted && location.reload());
  }

  /** Close permanently: this page shows nothing any more. */
  close(): void {
    this.worker.terminate();
  }

  on<K extends Kind>(kind: K, handler: (message: Of<K>) => void): void {
    const list = this.handlers.get(kind) ?? [];
    list.push(handler as (message: ServerMessage) => void);
    this.handlers.set(kind, list);
  }

  send(message: PageMessage): void {
    this.order({ kind: "send", message });
  }

  /** Send a request with an answer. A lost connection also counts as an answer. */
  request(message: WithoutNumber<Request>): Promise<Answer> {
    this.requests += 1;
    const request = this.requests;
    return new Promise((resolve) => {
      this.waiting.set(request, resolve);
      this.send({ ...message, request } as Request);
    });
  }

  /** The number of the last request, for interrupting it. */
  get lastRequest(): number {
    return this.requests;
  }

  /** The last poses are on the screen: request newer ones. */
  drawn(): void {
    this.order({ kind: "drawn" });
  }

  private pulse(): void {
    if (document.visibilityState === "visible") this.order({ kind: "pulse" });
  }

  private order(message: ToWorker): void {
    this.worker.postMessage(message);
  }

  private receive(news: FromWorker): void {
    if (news.kind === "poses") this.onPoses(decodePoses(news.frame));
    else if (news.kind === "state") {
      if (!news.open) this.giveUpWaiting("the connection was lost");
      this.state.set({ open: news.open, code: news.code, reason: news.reason });
    } else {
      for (const handler of this.handlers.get(news.message.type) ?? []) handler(news.message);
    }
  }

  private giveUpWaiting(error: string): void {
    for (const [request, resolve] of this.waiting) resolve({ type: "answer", request, ok: false, value: null, error });
    this.waiting.clear();
  }
}
