import type { Connection } from "../connection/connection";
import type { Seat } from "../generated/protocol";
import { h } from "../ui/dom";
import { icons } from "../ui/icons";
import { Signal } from "../ui/signal";

const EMPTY: Seat = { type: "seat", driver: null, asking: [], pages: 0 };

/** Shows the page that has control, requests control and hands it over. */
export class SeatPanel {
  readonly element = h("div", { class: "seat" });
  readonly drives = new Signal(false);
  private page = 0;
  private seat = EMPTY;

  /** @param onTaken called when the page takes over from another one, or from nobody */
  constructor(
    private readonly connection: Connection,
    onTaken: () => void,
  ) {
    connection.on("welcome", ({ page }) => {
      this.page = page;
      this.seat = EMPTY;
      this.render();
    });
    connection.on("seat", (seat) => {
      if (this.seat.pages > 0 && this.seat.driver !== this.page && seat.driver === this.page) onTaken();
      this.seat = seat;
      this.render();
    });
    connection.state.watch(({ open }) => !open && this.drives.set(false));
  }

  ask(): void {
    this.connection.send({ type: "ask_to_drive" });
  }

  private render(): void {
    const { driver, asking, pages } = this.seat;
    const drives = driver === this.page;
    this.drives.set(drives);
    const count = h("span", { class: "count", title: `${pages} ${pages === 1 ? "page watches" : "pages watch"}` });
    count.innerHTML = `${icons.people}<span>${pages}</span>`;
    const parts: HTMLElement[] = pages > 1 ? [count] : [];
    if (drives && pages > 1) parts.push(h("span", { class: "badge on" }, "you drive"));
    if (!drives) parts.push(this.askButton(asking.includes(this.page), driver === null));
    if (drives && asking.length > 0) parts.push(this.asked(asking));
    this.element.replaceChildren(...parts);
  }

  private askButton(asked: boolean, free: boolean): HTMLElement {
    const text = asked ? "request sent…" : free ? "take control" : "ask to drive";
    return h("button", { type: "button", disabled: asked, onclick: () => this.ask() }, text);
  }

  private asked(asking: number[]): HTMLElement {
    const to = asking[0] as number;
    return h(
      "div",
      { class: "asked", role: "alertdialog", "aria-label": "Another page would like to drive" },
      h("span", {}, `Page ${to} would like to drive.`),
      h("button", { type: "button", class: "primary", onclick: () => this.connection.send({ type: "hand_over", to }) }, "hand over"),
      h("button", { type: "button", onclick: () => this.connection.send({ type: "keep_driving" }) }, "keep driving"),
    );
  }
}
