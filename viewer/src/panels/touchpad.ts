import type { Keyboard } from "../input/keyboard";
import { h } from "../ui/dom";
import type { Signal } from "../ui/signal";

const KEYS = ["ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"] as const;
/** Directions of the keys on the pad, degrees clockwise from its upper edge. */
const TURNS = [0, 180, 270, 90];
/** Dead zone as a share of the radius. */
const DEAD = 0.3;
/** Share of the deflection from which an axis is active: diagonals press two keys at once. */
const SLANT = 0.38;

/** Drives by touch on devices without arrow keys. */
export class TouchPad {
  readonly element: HTMLElement;
  private readonly knob = h("span", { class: "knob" });
  private finger: number | null = null;
  /** A finger is put on the pad. */
  onDrive = (): void => {};

  constructor(
    private readonly keyboard: Keyboard,
    drives: Signal<boolean>,
    robots: Signal<string[]>,
  ) {
    this.element = h("div", { class: "touchpad", role: "group", "aria-label": "drive", hidden: true }, ...TURNS.map((turn) => h("span", { class: "direction", style: `--turn: ${turn}deg` })), this.knob);
    const show = (): void => {
      this.element.hidden = !drives.value || robots.value.length === 0;
      if (this.element.hidden) this.release();
    };
    drives.watch(show);
    robots.watch(show);
    this.element.addEventListener("pointerdown", (event) => this.down(event));
    this.element.addEventListener("pointermove", (event) => event.pointerId === this.finger && this.steer(event));
    for (const kind of ["pointerup", "pointercancel", "lostpointercapture"] as const) {
      this.element.addEventListener(kind, (event) => event.pointerId === this.finger && this.release());
    }
    addEventListener("blur", () => this.release());
  }

  private down(event: PointerEvent): void {
    event.preventDefault();
    this.finger = event.pointerId;
    this.element.setPointerCapture(event.pointerId);
    this.onDrive();
    this.steer(event);
  }

  private steer(event: PointerEvent): void {
    const { left, top, width } = this.element.getBoundingClientRect();
    const radius = width / 2;
    const [x, y] = [(event.clientX - left - radius) / radius, (event.clientY - top - radius) / radius];
    const length = Math.hypot(x, y);
    const cut = Math.min(1, 0.62 / Math.max(length, 1e-6));
    this.knob.style.transform = `translate(${x * cut * radius}px, ${y * cut * radius}px)`;
    const far = length > DEAD;
    this.hold([far && -y / length > SLANT, far && y / length > SLANT, far && -x / length > SLANT, far && x / length > SLANT]);
  }

  private release(): void {
    this.finger = null;
    this.knob.style.transform = "";
    this.hold([false, false, false, false]);
  }

  private hold(pressed: boolean[]): void {
    KEYS.forEach((key, i) => this.keyboard.press(key, pressed[i] === true));
  }
}
