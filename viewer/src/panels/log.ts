import type { Connection } from "../connection/connection";
import { h } from "../ui/dom";
import type { Toasts } from "./toasts";

const MOST = 500;

/** What the simulation says. */
export class LogPanel {
  readonly element = h("section", { class: "log", role: "log", "aria-label": "messages", tabIndex: 0, hidden: true });

  constructor(connection: Connection, toasts: Toasts) {
    connection.on("log", ({ level, text, source, time }) => {
      this.element.hidden = false;
      const below = this.element.scrollHeight - this.element.scrollTop - this.element.clientHeight < 20;
      this.element.append(h("p", { class: level }, h("time", {}, time.toFixed(2)), " ", source !== "" && h("b", {}, `${source} `), text));
      while (this.element.childElementCount > MOST) this.element.firstElementChild?.remove();
      if (below) this.element.scrollTop = this.element.scrollHeight;
      if (level === "error" || level === "warning") toasts.show(text, level === "error" ? "error" : "info");
    });
  }
}
