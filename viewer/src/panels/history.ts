import type { Connection } from "../connection/connection";
import type { PoseFrame } from "../connection/frames";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Signal } from "../ui/signal";
import { formatTime, isDate } from "./clock";

/** A slider over the saved states while the simulation is paused; over the whole run during a replay, always. */
export class HistoryPanel {
  readonly element: HTMLElement;
  private times: number[] = [];
  private recorded = false;
  private readonly backward = iconButton(icons.reverse, "Play backward", () => this.connection.send({ type: "play_backward" }));
  private now = 0;
  private readonly slider = h("input", { type: "range", min: "0", step: "1", "aria-label": "go back in time", oninput: () => this.go() });
  private readonly label = h("output", { "aria-label": "time that is gone back to" });

  constructor(
    private readonly connection: Connection,
    private readonly poses: Signal<PoseFrame | null>,
    private readonly drives: Signal<boolean>,
  ) {
    this.element = h("div", { class: "history", hidden: true }, this.backward, iconButton(icons.back, "Back", () => this.stepBack(), ","), this.slider, this.label);
    this.backward.hidden = true;
    connection.on("history", ({ times, recorded }) => {
      this.times = times;
      this.recorded = recorded ?? false;
      this.backward.hidden = !this.recorded;
      this.slider.max = String(Math.max(0, times.length - 1));
      this.show();
    });
    poses.watch((frame) => {
      if (frame && frame.time !== this.now) this.now = frame.time;
      this.show();
    });
    drives.watch(() => this.show());
  }

  /** Go to the saved state before the present one. */
  stepBack(): void {
    this.connection.send({ type: "step_back" });
  }

  private go(): void {
    const time = this.times[Number(this.slider.value)];
    if (time !== undefined) this.connection.send({ type: "rewind", time });
  }

  private show(): void {
    this.element.hidden = this.poses.value === null || (this.poses.value.running && !this.recorded) || this.times.length === 0 || !this.drives.value;
    if (this.element.hidden) return;
    // the state that is shown, or the last state before it
    let at = this.times.length - 1;
    while (at > 0 && (this.times[at] as number) > this.now + 1e-9) at -= 1;
    if (document.activeElement !== this.slider || !this.slider.matches(":active")) this.slider.value = String(at);
    if (this.recorded) {
      const [first, last] = [this.times[0] as number, this.times.at(-1) as number];
      const begin = isDate(first) ? first : 0;
      const text = formatTime(Math.max(this.now - begin, 0));
      this.label.textContent = `${text} / ${formatTime(last - begin)}`;
      this.slider.ariaValueText = text;
      return;
    }
    const ago = (this.times.at(-1) as number) - this.now;
    this.label.textContent = ago > 1e-9 ? `−${ago.toFixed(2)} s` : formatTime(this.now);
    this.slider.ariaValueText = formatTime(this.now);
  }
}
