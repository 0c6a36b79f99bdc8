import type { Connection } from "../connection/connection";

const EVERY = 50; // ms
const REST = 0.08; // sticks are never exactly at rest

/** The first gamepad: its axes and buttons are sent to the simulation while it is used. */
export class Pad {
  private told = "";

  constructor(private readonly connection: Connection) {
    addEventListener("gamepaddisconnected", () => this.release());
    addEventListener("blur", () => this.release());
    setInterval(() => this.poll(), EVERY);
  }

  private poll(): void {
    if (document.visibilityState === "hidden" || !document.hasFocus()) return;
    const pad = navigator.getGamepads().find((one) => one !== null);
    if (!pad) return;
    const axes = pad.axes.slice(0, 32).map((value) => (Math.abs(value) < REST ? 0 : Math.max(-1, Math.min(1, value))));
    const buttons = pad.buttons.slice(0, 64).map(({ pressed }) => pressed);
    const busy = axes.some((value) => value !== 0) || buttons.some(Boolean);
    const text = JSON.stringify([axes, buttons]);
    // held buttons are sent repeatedly, like keys
    if (text === this.told && !busy) return;
    this.told = text;
    this.connection.send({ type: "gamepad", axes, buttons });
  }

  private release(): void {
    if (this.told === "") return;
    this.told = "";
    this.connection.send({ type: "gamepad", axes: [], buttons: [] });
  }
}
