import type { Connection } from "../connection/connection";
import { h } from "../ui/dom";

const OTHER_VERSION = 4000;
const POLICY: Record<number, string> = {
  1001: "The simulation has ended. Waiting for it to start again…",
  1006: "The connection is lost. Trying again…",
};

/** A line across the view while there is no connection. */
export class LinkBanner {
  readonly element = h("div", { class: "link", role: "alert" }, "Connecting…");
  private ever = false;

  constructor(connection: Connection) {
    connection.state.watch(({ open, code, reason }) => {
      this.element.hidden = open;
      if (open) this.ever = true;
      else if (code === OTHER_VERSION) this.say(reason, true);
      else if (code !== 0) this.say(!this.ever ? "The simulator does not answer. Trying again…" : (POLICY[code] ?? reason), false);
      if (!open && code === 1006) void this.whyRefused();
    });
  }

  private say(text: string, reload: boolean): void {
    const button = reload && h("button", { type: "button", onclick: () => location.reload() }, "reload");
    this.element.replaceChildren(text, " ", button || "");
  }

  /** A refused connection says nothing of why; a plain request does. */
  private async whyRefused(): Promise<void> {
    try {
      const answer = await fetch("ws");
      if (answer.status === 403) this.say(await answer.text(), false);
    } catch {
      // not there at all: that is what the line says
    }
  }
}
