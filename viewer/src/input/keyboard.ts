import type { Connection } from "../connection/connection";
import { isTyping } from "../ui/dom";
import { CAMERA_KEYS } from "./camerakeys";

const AGAIN = 250; // ms

/** The pressed keys, sent to the simulation at every change. */
export class Keyboard {
  readonly held = new Set<string>();
  /** whether Ctrl is pressed to look around, so that other keys fly */
  flies: () => boolean = () => false;
  /** whether this page drives: keys that another page sends while it takes over must not drive */
  drives: () => boolean = () => false;
  /** an arrow key was pressed to drive */
  onArrow: () => void = () => {};

  constructor(private readonly connection: Connection) {
    addEventListener("keydown", (event) => this.down(event));
    addEventListener("keyup", (event) => this.up(event));
    addEventListener("blur", () => this.release());
    document.addEventListener("visibilitychange", () => {
      if (document.visibilityState === "hidden") this.release();
    });
    // when focus moves into a text field, all keys count as released
    addEventListener("focusin", (event) => isTyping(event) && this.release());
    // sent again at intervals: messages that were dropped while the page hung are repeated
    setInterval(() => this.held.size > 0 && this.tell(), AGAIN);
    connection.state.watch(({ open }) => open && this.held.size > 0 && this.tell());
  }

  /** A key of the page itself, e.g. of the pad on a touch screen. */
  press(code: string, down: boolean): void {
    if (down === this.held.has(code)) return;
    if (down) this.held.add(code);
    else this.held.delete(code);
    this.tell();
  }

  release(): void {
    if (this.held.size === 0) return;
    this.held.clear();
    this.tell();
  }

  private down(event: KeyboardEvent): void {
    if (isTyping(event) || event.metaKey || event.altKey || event.isComposing) return;
    if (event.ctrlKey && !event.code.startsWith("Control") && !(this.flies() && CAMERA_KEYS.has(event.code))) return;
    if (event.code.startsWith("Arrow") && isSteered(event.target)) return;
    if (event.code.startsWith("Arrow")) event.preventDefault();
    if (event.repeat || event.code === "") return;
    this.held.add(event.code);
    this.tell();
    if (event.code.startsWith("Arrow") && !event.ctrlKey && this.drives()) this.onArrow();
  }

  private up(event: KeyboardEvent): void {
    // while Meta is pressed, browsers do not report that other keys are released
    if (event.key === "Meta") this.release();
    if (this.held.delete(event.code)) this.tell();
  }

  private tell(): void {
    if (this.drives()) this.connection.send({ type: "keys", held: [...this.held].slice(0, 32) });
  }
}

/** Whether an element uses the arrow keys itself. */
function isSteered(target: EventTarget | null): boolean {
  return target instanceof HTMLElement && target.closest('[role="tree"], [role="menu"], [role="slider"], [role="tablist"], input') !== null;
}
