import type { Connection } from "../connection/connection";
import type { RecordingDescription } from "../generated/protocol";
import { disable, h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Signal } from "../ui/signal";
import { formatTime } from "./clock";
import { showFoxglove } from "./foxglove";
import type { Toasts } from "./toasts";

interface Line {
  element: HTMLElement;
  text: HTMLElement;
  stop: HTMLElement;
}

/** Records the run into a file, and shows its duration and its path. */
export class RecordingPanel {
  readonly button = iconButton(icons.record, "Record the run", () => void this.toggle());
  /** over the view: the present recordings, and the path of the last one */
  readonly element = h("div", { class: "recordings" });
  private running: RecordingDescription[] = [];
  private saved: string | null = null;
  private possible = true;
  private readonly lines = new Map<string, Line>();
  private savedElement: HTMLElement | null = null;

  constructor(
    private readonly connection: Connection,
    private readonly drives: Signal<boolean>,
    private readonly toasts: Toasts,
  ) {
    this.button.classList.add("record");
    connection.on("recordings", ({ recordings, possible }) => {
      // a recording that is no longer listed is complete, whatever stopped it
      const ended = this.running.find((old) => !recordings.some(({ path }) => path === old.path));
      if (ended) this.saved = ended.path;
      this.running = recordings;
      this.possible = possible;
      this.show();
    });
    drives.watch(() => this.show());
  }

  private get own(): RecordingDescription | null {
    return this.running.find(({ stoppable }) => stoppable) ?? null;
  }

  /** Start a recording, or stop the one that the page can stop. */
  async toggle(): Promise<void> {
    const service = this.own ? "stop_recording" : "start_recording";
    const { ok, value, error } = await this.connection.request({ type: "call_service", component: "simulation", service, arguments: [] });
    if (!ok) this.toasts.show(`The run is not recorded: ${error}`, "error");
    else if (service === "stop_recording") {
      this.saved = String(value);
      this.show();
    } else this.saved = null;
  }

  /** Say how Foxglove opens the present recording, or the last one. */
  openInFoxglove(): void {
    const path = this.running[0]?.path ?? this.saved;
    const stoppable = this.running.length === 0 || this.own !== null;
    const toggle = this.possible && this.drives.value && stoppable && (path === null || this.own !== null) ? (): void => void this.toggle() : null;
    showFoxglove({ path, running: this.running.length > 0, toggle, copy: (text) => void this.copy(text) });
  }

  private show(): void {
    const { own, button } = this;
    button.hidden = !this.possible;
    button.innerHTML = own ? icons.stop : icons.record;
    button.ariaLabel = button.title = own ? "Stop recording" : "Record the run";
    button.setAttribute("aria-pressed", String(own !== null));
    disable(button, !this.drives.value);
    const lines = this.running.map((one) => this.line(one));
    if (this.saved !== null && !this.running.some(({ path }) => path === this.saved)) lines.push(this.savedLine(this.saved));
    // existing elements stay in place: they may have the focus
    for (const old of [...this.element.children]) if (!lines.includes(old as HTMLElement)) old.remove();
    for (const line of lines) if (!line.isConnected) this.element.append(line);
  }

  private line({ path, seconds, bytes, stoppable }: RecordingDescription): HTMLElement {
    const known = this.lines.get(path) ?? this.makeLine(path);
    known.text.textContent = `${formatTime(seconds)} · ${formatSize(bytes)}`;
    known.stop.hidden = !(stoppable && this.drives.value);
    return known.element;
  }

  private makeLine(path: string): Line {
    const text = h("span", {});
    const stop = iconButton(icons.stop, "Stop recording", () => void this.toggle());
    const element = h("p", { class: "recording on", title: path }, h("b", {}, fileOf(path)), text, stop);
    const line = { element, text, stop };
    this.lines.set(path, line);
    return line;
  }

  private savedLine(path: string): HTMLElement {
    if (this.savedElement?.title === path) return this.savedElement;
    const close = iconButton(icons.close, "Close", () => {
      this.saved = null;
      this.show();
    });
    const text = h("span", {}, "recorded: ", h("code", {}, path), h("span", { class: "quiet" }, " · again here: morse replay"));
    const foxglove = h("button", { type: "button", onclick: () => this.openInFoxglove() }, "open in Foxglove");
    this.savedElement = h("p", { class: "recording", title: path, role: "status" }, text, foxglove, iconButton(icons.copy, "Copy the path", () => void this.copy(path)), close);
    return this.savedElement;
  }

  private async copy(text: string): Promise<void> {
    try {
      await navigator.clipboard.writeText(text);
      this.toasts.show("It is on the clipboard.");
    } catch {
      // without a secure connection, browsers do not allow access to the clipboard
      this.toasts.show(text);
    }
  }
}

function fileOf(path: string): string {
  return path.split(/[\\/]/).at(-1) ?? path;
}

/** A size with a unit. */
export function formatSize(bytes: number): string {
  if (bytes < 1000) return `${bytes} B`;
  const units = ["kB", "MB", "GB", "TB"];
  const power = Math.min(Math.floor(Math.log10(bytes) / 3), units.length);
  const size = bytes / 1000 ** power;
  return `${size < 10 ? size.toFixed(1) : size.toFixed(0)} ${units[power - 1]}`;
}
