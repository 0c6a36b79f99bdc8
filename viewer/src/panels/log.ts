import type { Connection } from "../connection/connection";
import type { Log } from "../generated/protocol";
import type { Components } from "../model/components";
import { h, reveal } from "../ui/dom";
import { formatTime, isDate } from "./clock";
import type { Toasts } from "./toasts";

const MOST = 500;

/** The log of the simulation; a line about a component is a link to the component. */
export class LogPanel {
  readonly element = h("section", { class: "log", role: "log", "aria-label": "messages", tabIndex: 0 });
  /** beside plots, shows the messages or hides them */
  readonly tab = h("button", { type: "button", class: "messages", title: "Show or hide the messages", onclick: () => this.toggle() }, "messages");
  private readonly empty = h("p", { class: "quiet" }, "No messages yet.");
  /** earlier lines that are sent to a new page do not count as new */
  private fresh = false;
  /** the first error that came while the log was hidden: it is shown when the log is opened, not the end */
  private unread: Element | null = null;

  constructor(
    connection: Connection,
    private readonly components: Components,
    private readonly toasts: Toasts,
    private readonly onNews: (level: Log["level"]) => void,
    /** a message of a line was clicked */
    private readonly onOpen: (text: string) => void,
  ) {
    this.element.append(this.empty);
    // lines that were added while the log was hidden are shown from the end
    new ResizeObserver(() => {
      this.element.scrollTop = this.element.scrollHeight;
      if (!this.element.checkVisibility() || !this.unread) return;
      this.mark(this.unread);
      this.unread = null;
    }).observe(this.element);
    connection.on("welcome", () => {
      this.fresh = false;
      this.element.replaceChildren(this.empty);
    });
    connection.on("seat", () => (this.fresh = true));
    connection.on("log", (line) => this.add(line));
  }

  private toggle(): void {
    this.element.dataset["open"] = this.element.checkVisibility() ? "no" : "yes";
  }

  /** Scroll to the last error that contains a text. */
  reveal(text: string): void {
    this.element.dataset["open"] = "yes";
    const line = [...this.element.querySelectorAll("p.error, p.warning")].filter((one) => one.textContent?.includes(text)).at(-1);
    this.unread = null;
    this.mark(line ?? null);
  }

  private mark(line: Element | null): void {
    for (const other of this.element.querySelectorAll(".found")) other.classList.remove("found");
    line?.classList.add("found");
    if (line) reveal(line, "center");
  }

  private add({ level, text, component, time, shown }: Log): void {
    this.empty.remove();
    const below = this.element.scrollHeight - this.element.scrollTop - this.element.clientHeight < 20;
    const select = (): void => this.components.selected.set(component);
    const about = component !== "" && h("button", { type: "button", class: "about", title: `select ${component}`, onclick: select }, component);
    // what the page shows elsewhere does not open the messages
    this.element.append(h("p", { class: shown ? `${level} known` : level }, h("time", { title: "simulated time, s" }, isDate(time) ? formatTime(time) : time.toFixed(2)), about, h("span", {}, text)));
    while (this.element.childElementCount > MOST) this.element.firstElementChild?.remove();
    if (below) this.element.scrollTop = this.element.scrollHeight;
    if (level !== "error" && level !== "warning") return;
    if (component !== "") this.components.complain(component, level, text);
    if (!this.fresh || shown) return;
    if (this.element.dataset["open"] === "no") delete this.element.dataset["open"];
    if (level === "error" && !this.element.checkVisibility()) this.unread ??= this.element.lastElementChild;
    this.onNews(level);
    this.toasts.show(firstLine(text) + placeIn(text), level === "error" ? "error" : "info", () => this.onOpen(text));
  }
}

function firstLine(text: string): string {
  const [line = ""] = text.replace(/^(\[\w+\])+ /, "").split("\n");
  return line.length > 300 ? `${line.slice(0, 300)}…` : line;
}

/** File and line of an error in the code of a user: the innermost one. */
function placeIn(text: string): string {
  const place = [...text.matchAll(/File "([^"\n]+)", line (\d+)/g)].at(-1);
  return place ? ` (${(place[1] as string).split(/[\\/]/).at(-1)}, line ${place[2]})` : "";
}
