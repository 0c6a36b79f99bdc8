import { CAMERA_KEYS } from "./camerakeys";
import type { Keyboard } from "./keyboard";

/** Time after the last key that flies or drives, or the last look around, for which the page is kept open, ms. */
const AFTER = 1500;

/**
 * Keeps keys of the browser from closing or reloading the page while the user flies, drives or looks around.
 *
 * The page can intercept Ctrl+R, Ctrl+S, Ctrl+F and the like, but not Ctrl+W: therefore the browser asks before the
 * page is left.
 */
export class Accidents {
  private last = -Infinity;
  private looking = false;

  constructor(
    private readonly keyboard: Keyboard,
    canvas: HTMLCanvasElement,
  ) {
    keyboard.flies = () => this.busy;
    addEventListener("keydown", (event) => {
      if (event.ctrlKey && this.busy && CAMERA_KEYS.has(event.code) && isView(event.target)) event.preventDefault();
    });
    addEventListener("keyup", (event) => {
      if (CAMERA_KEYS.has(event.code) || event.code.startsWith("Arrow")) this.last = performance.now();
      if (event.key === "Control" && this.looking) this.stopLooking();
    });
    for (const kind of ["pointermove", "pointerdown"] as const) canvas.addEventListener(kind, (event) => event.ctrlKey && (this.looking = true));
    addEventListener("blur", () => this.looking && this.stopLooking());
    addEventListener("beforeunload", (event) => this.busy && event.preventDefault());
  }

  private get busy(): boolean {
    const held = [...this.keyboard.held].some((code) => CAMERA_KEYS.has(code) || code.startsWith("Arrow"));
    return held || this.looking || performance.now() - this.last < AFTER;
  }

  private stopLooking(): void {
    this.looking = false;
    this.last = performance.now();
  }
}

function isView(target: EventTarget | null): boolean {
  return target === document.body || target instanceof HTMLCanvasElement;
}
