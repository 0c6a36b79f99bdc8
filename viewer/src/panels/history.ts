import type { Connection } from "../connection/connection";
import type { PoseFrame } from "../connection/frames";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Signal } from "../ui/signal";
import { formatTime } from "./clock";

/** While time stands still: a slider over the states that can be gone back to. */
export class HistoryPanel {
  readonly element: HTMLElement;
  private times: number[] = [];
  private now = 0;
  private readonly slider = h("input", { type: "range", min: "0", step: "1", "aria-label": "go back in time", oninput: () => this.go() });
  private readonly label = h("output", { "aria-label": "time that is gone back to" });

  constructor(
    private readonly connection: Connection,
    private readonly poses: Signal<PoseFrame | null>,
    private readonly drives: Signal<boolean>,
  ) {
    this.element = h("div", { class: "history", hidden: true }, iconButton(icons.back, "Back", () => this.stepBack(), ","), this.slider, this.label);
    connection.on("history", ({ times }) => {
      this.times = times;
      this.slider.max = String(Math.max(0, times.length - 1));
      this.show();
    });
    poses.watch((frame) => {
      if (frame && frame.time !== this.now) this.now = frame.time;
      this.show();
    });
    drives.watch(() => this.show());
  }

  /** Go to the state that was kept before the present one. */
  stepBack(): void {
    this.connection.send({ type: "step_back" });
  }

  private go(): void {
    const time = this.times[Number(this.slider.value)];
    if (time !== undefined) this.connection.send({ type: "rewind", time });
  }

  private show(): void {
    this.element.hidden = this.poses.value === null || this.poses.value.running || this.times.length === 0 || !this.drives.value;
    if (this.element.hidden) return;
    // the state that is shown, or the last one before it
    let at = this.times.length - 1;
    while (at > 0 && (this.times[at] as number) > this.now + 1e-9) at -= 1;
    if (document.activeElement !== this.slider || !this.slider.matches(":active")) this.slider.value = String(at);
    const ago = (this.times.at(-1) as number) - this.now;
    this.label.textContent = ago > 1e-9 ? `−${ago.toFixed(2)} s` : formatTime(this.now);
    this.slider.ariaValueText = formatTime(this.now);
  }
}
