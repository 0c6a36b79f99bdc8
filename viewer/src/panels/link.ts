import type { Connection } from "../connection/connection";
import { h } from "../ui/dom";

const OTHER_VERSION = 4000;
const NOT_UNDERSTOOD = 4001;
const GOING_AWAY = 1001;

/** A banner over the view while there is no connection. */
export class LinkBanner {
  readonly element = h("div", { class: "link", role: "alert" }, "Connecting…");
  private ever = false;
  private ended = false;
  private said = "";

  constructor(connection: Connection) {
    connection.state.watch(({ open, code, reason }) => {
      this.element.hidden = open;
      if (open) {
        this.ever = true;
        this.ended = false;
      } else if (code === OTHER_VERSION) this.say(reason, true);
      else if (code !== 0) this.explain(code, reason);
    });
  }

  private explain(code: number, reason: string): void {
    // attempts to reconnect to a simulation that has ended fail, too
    this.ended ||= code === GOING_AWAY;
    if (this.ended) this.say("The simulation has ended. Waiting for it to start again…", false);
    else if (code === NOT_UNDERSTOOD) this.say(`${reason}. Trying again…`, false);
    else this.say(this.ever ? "The connection is lost. Trying again…" : "The simulator does not answer. Trying again…", false);
    if (!this.ended) void this.whyRefused();
  }

  private say(text: string, reload: boolean): void {
    if (text === this.said) return; // the button stays where it is
    this.said = text;
    const button = reload && h("button", { type: "button", onclick: () => location.reload() }, "reload");
    this.element.replaceChildren(text, " ", button || "");
  }

  /** A refused WebSocket gives no reason; a plain HTTP request does. */
  private async whyRefused(): Promise<void> {
    try {
      const answer = await fetch("ws");
      if (answer.status === 403) this.say(await answer.text(), false);
    } catch {
      // no server: the banner already says so
    }
  }
}
