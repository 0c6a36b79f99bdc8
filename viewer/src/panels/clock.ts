import { tape } from "../connection/tape";
import type { Connection } from "../connection/connection";
import type { PoseFrame } from "../connection/frames";
import type { Pace } from "../generated/protocol";
import { ask } from "../ui/ask";
import { disable, h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";

const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10];
const LATE = 0.9;
/** Time in which the simulator takes over a requested speed, ms. */
const TAKEOVER = 1000;

/** Simulated time, its speed, and its controls. */
export class Clock {
  readonly element: HTMLElement;
  private running = true;
  private readonly time = h("output", { class: "time", title: "simulated time", "aria-label": "simulated time" }, "–");
  private readonly factor = h("output", { class: "factor", title: "real-time factor", "aria-label": "real-time factor" }, "");
  /** shown over the view when the machine cannot keep up */
  readonly warning = h("p", { class: "notice late", role: "status", hidden: true });
  private readonly play = iconButton(icons.pause, "Pause", () => this.toggle(), "P");
  private readonly stepButton = iconButton(icons.step, "One tick", () => this.step(), ".");
  private readonly speed = h("select", { title: "speed", "aria-label": "speed", onchange: () => this.setSpeed() });
  /** what stands elsewhere on a phone */
  private readonly rest: HTMLElement[];
  private readonly buttons: (HTMLButtonElement | HTMLSelectElement)[];
  /** the speed of the last frame */
  private told = 1;
  /** until a different choice of the user counts as refused */
  private takeover: ReturnType<typeof setTimeout> | undefined;
  private pace: Pace | null = null;
  /** files that are read again at a restart */
  private edited: string[] = [];

  constructor(private readonly connection: Connection) {
    const reset = iconButton(icons.reset, "Reset", () => this.reset(), "F11");
    this.buttons = [this.play, this.stepButton, reset, this.speed];
    for (const speed of SPEEDS) this.speed.append(h("option", { value: String(speed) }, `×${speed}`));
    this.speed.append(h("option", { value: "max" }, "max"));
    this.speed.value = "1";
    this.rest = [this.stepButton, reset, this.speed];
    this.element = h("div", { class: "clock" }, this.play, ...this.rest, this.time, this.factor);
    connection.on("saved_files", ({ waiting }) => (this.edited = waiting));
    connection.on("pace", (pace) => {
      this.pace = pace;
      this.showPace();
    });
    connection.state.watch(({ open }) => {
      if (open) return;
      this.pace = null; // a simulation that has ended is not late
      this.showPace();
    });
  }

  /** Move all but play and the time into another element, or back. */
  lend(place: HTMLElement | null): void {
    if (place) place.prepend(...this.rest);
    else this.play.after(...this.rest);
  }

  /** Watchers see the controls, but cannot use them. */
  enable(enabled: boolean): void {
    for (const button of this.buttons) disable(button, !enabled);
  }

  show(frame: PoseFrame): void {
    this.time.textContent = formatTime(frame.time);
    this.time.title = isDate(frame.time) ? `${new Date(frame.time * 1000).toISOString().slice(0, 10)} UTC` : "simulated time";
    const slow = frame.running && Number.isFinite(frame.speed) && frame.realTimeFactor < LATE * frame.speed;
    this.showFactor(frame.running ? frame.realTimeFactor : null);
    this.factor.classList.toggle("slow", slow);
    if (frame.running !== this.running) {
      this.running = frame.running;
      this.play.innerHTML = frame.running ? icons.pause : icons.play;
      this.play.ariaLabel = frame.running ? "Pause" : "Play";
      this.play.title = `${this.play.ariaLabel} (P)`;
      this.showPace();
    }
    // a speed that held for a moment only may be in no frame: then the choice of the user is shown until it is refused
    if (frame.speed !== this.told) this.showSpeed(frame.speed);
  }

  private showFactor(factor: number | null): void {
    const text = factor === null ? "paused" : `${factor.toFixed(2)}×`;
    if (this.factor.dataset["shown"] === text) return;
    this.factor.dataset["shown"] = text;
    this.factor.replaceChildren(text, factor === null ? "" : h("span", { class: "words" }, " real time"));
  }

  toggle(): void {
    this.connection.send({ type: this.running ? "pause" : "play" });
  }

  step(): void {
    if (this.running) this.connection.send({ type: "pause" });
    this.connection.send({ type: "step", count: 1 });
  }

  /** Restart after a confirmation; a run in this page loses nothing. */
  reset(): void {
    if (tape) {
      this.connection.send({ type: "reset" });
      return;
    }
    const also = this.edited.length > 0 ? ` ${this.edited.join(", ")} was saved, and is read again.` : "";
    ask(`Reset everything to the beginning?${also}`, "reset", () => this.connection.send({ type: "reset" }));
  }

  /** End the simulation after a confirmation. */
  quit(): void {
    ask("End the simulation? Programs that control robots lose their connection.", "end it", () => this.connection.send({ type: "quit" }));
  }

  private setSpeed(): void {
    this.connection.send({ type: "set_speed", factor: this.speed.value === "max" ? null : Number(this.speed.value) });
    this.speed.blur();
    clearTimeout(this.takeover);
    this.takeover = setTimeout(() => this.showSpeed(this.told), TAKEOVER);
  }

  private showSpeed(speed: number): void {
    this.told = speed;
    clearTimeout(this.takeover);
    const value = Number.isFinite(speed) ? String(Number(speed.toPrecision(4))) : "max";
    if (![...this.speed.options].some((option) => option.value === value)) {
      this.speed.append(h("option", { value }, `×${value}`));
    }
    this.speed.value = value;
  }

  private showPace(): void {
    const { late = 0, cause = "" } = this.pace ?? {};
    this.warning.hidden = late <= 0 || !this.running;
    this.warning.textContent = `${late.toFixed(1)} s behind${cause === "" ? "" : `; ${cause}`}`;
    this.warning.title = this.pace ? `${this.pace.strategy}: the simulation cannot keep up` : "";
  }
}

/** Times since 1970 are larger than this, those of a run smaller. */
const DATED = 1e8;

/** Whether a time is a date: the clock of the run shows the time of day. */
export function isDate(seconds: number): boolean {
  return seconds >= DATED;
}

/** A time of the run; of a run with the time of day, that of UTC. */
export function formatTime(seconds: number): string {
  if (isDate(seconds)) return new Date(Math.round(seconds * 100) * 10).toISOString().slice(11, 22);
  const whole = Math.floor(seconds);
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  const rest = (seconds - Math.floor(whole / 60) * 60).toFixed(2).padStart(5, "0");
  const two = (n: number): string => String(n).padStart(2, "0");
  return hours > 0 ? `${hours}:${two(minutes)}:${rest}` : `${minutes}:${rest}`;
}
