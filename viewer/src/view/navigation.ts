import { Vector3 } from "three";
import { FLY } from "../input/camerakeys";
import type { Keyboard } from "../input/keyboard";
import { pointUnder } from "./pick";
import type { Stage } from "./stage";

const AIM = 0.0035; // radians per pixel
const CLICK = 4; // pixels: longer movements are drags
const FAST = 4;

/** Moves the camera: flies by keys, aims by Ctrl and mouse, orbits, pans and zooms by mouse or fingers. */
export class Navigation {
  /** metres per second */
  speed = 2;
  /** called when the user moves the camera */
  onTaken: () => void = () => {};
  onClick: (x: number, y: number, more: boolean) => void = () => {};
  /** whether another object, e.g. a handle, handles the drag that begins here */
  claims: (event: PointerEvent) => boolean = () => false;
  private readonly pointers = new Map<number, { x: number; y: number }>();
  private readonly pivot = new Vector3();
  private readonly velocity = new Vector3();
  private travelled = 0;
  private mode: "orbit" | "pan" | "aim" | null = null;
  private last: { x: number; y: number } | null = null;

  constructor(
    private readonly stage: Stage,
    private readonly keyboard: Keyboard,
  ) {
    const canvas = stage.renderer.domElement;
    canvas.style.touchAction = "none";
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", (event) => this.up(event));
    canvas.addEventListener("pointerleave", () => (this.last = null));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    stage.onStep((seconds) => this.fly(seconds));
  }

  private down(event: PointerEvent): void {
    const canvas = this.stage.renderer.domElement;
    (document.activeElement as HTMLElement | null)?.blur();
    if (this.claims(event)) return;
    canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.travelled = 0;
    this.mode = event.ctrlKey ? "aim" : event.button === 0 && !event.shiftKey ? "orbit" : "pan";
    if (this.pointers.size === 1) this.pivot.copy(pointUnder(this.stage, event.clientX, event.clientY));
  }

  private move(event: PointerEvent): void {
    const was = this.pointers.get(event.pointerId) ?? (event.ctrlKey ? this.last : null);
    this.last = { x: event.clientX, y: event.clientY };
    if (!was) return;
    const [dx, dy] = [event.clientX - was.x, event.clientY - was.y];
    this.travelled += Math.hypot(dx, dy);
    if (this.pointers.size === 2) this.pinch(event, dx, dy);
    else if (this.pointers.size === 0) this.aim(dx, dy);
    else if (this.travelled > CLICK) this.drag(dx, dy);
    if (this.pointers.has(event.pointerId)) this.pointers.set(event.pointerId, this.last);
  }

  private up(event: PointerEvent): void {
    const known = this.pointers.delete(event.pointerId);
    if (known && this.pointers.size === 0) {
      if (this.travelled <= CLICK && event.button === 0) this.onClick(event.clientX, event.clientY, event.shiftKey || event.ctrlKey || event.metaKey);
      this.mode = null;
    }
  }

  private drag(dx: number, dy: number): void {
    if (this.mode === "aim") this.aim(dx, dy);
    else if (this.mode === "pan") this.pan(dx, dy);
    else this.orbit(dx, dy);
  }

  private aim(dx: number, dy: number): void {
    this.stage.view.turn(-dx * AIM, -dy * AIM);
    this.taken();
  }

  private orbit(dx: number, dy: number): void {
    const { view } = this.stage;
    const arm = view.position.clone().sub(this.pivot);
    // the offset to the pivot is constant in the axes of the camera while it rotates
    const [side, over, along] = [arm.dot(view.right), arm.dot(view.above), arm.dot(view.ahead)];
    view.turn(-dx * AIM * 1.6, -dy * AIM * 1.6);
    view.position.copy(this.pivot).addScaledVector(view.right, side).addScaledVector(view.above, over).addScaledVector(view.ahead, along);
    this.taken();
  }

  private pan(dx: number, dy: number): void {
    const { view, element } = this.stage;
    const depth = Math.max(0.5, this.pivot.clone().sub(view.position).dot(view.ahead));
    const metres = (2 * depth * Math.tan((view.camera.fov * Math.PI) / 360)) / element.clientHeight;
    view.position.addScaledVector(view.right, -dx * metres).addScaledVector(view.above, dy * metres);
    this.taken();
  }

  private pinch(event: PointerEvent, dx: number, dy: number): void {
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    const own = this.pointers.get(event.pointerId);
    if (!other || !own) return;
    const before = Math.hypot(own.x - other.x, own.y - other.y);
    const after = Math.hypot(own.x + dx - other.x, own.y + dy - other.y);
    this.zoom(before / Math.max(after, 1), (own.x + other.x) / 2, (own.y + other.y) / 2);
    this.pan(dx / 2, dy / 2);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const pixels = event.deltaY * (event.deltaMode === 1 ? 30 : 1);
    this.zoom(Math.exp(Math.max(-120, Math.min(120, pixels)) * 0.0016), event.clientX, event.clientY);
  }

  /** Zoom towards the point under the pointer, by a factor. */
  private zoom(factor: number, x: number, y: number): void {
    const { view } = this.stage;
    const target = pointUnder(this.stage, x, y);
    const way = view.position.clone().sub(target);
    const length = Math.min(Math.max(way.length() * factor, 0.15), 2000);
    view.position.copy(target).addScaledVector(way.normalize(), length);
    this.taken();
  }

  private fly(seconds: number): boolean {
    const on = (codes: string[]): number => (codes.some((code) => this.keyboard.held.has(code)) ? 1 : 0);
    const { view } = this.stage;
    const wanted = new Vector3()
      .addScaledVector(view.ahead, on(FLY.ahead) - on(FLY.back))
      .addScaledVector(view.right, on(FLY.right) - on(FLY.left));
    wanted.z += on(FLY.up) - on(FLY.down);
    const fast = this.keyboard.held.has("ShiftLeft") || this.keyboard.held.has("ShiftRight") ? FAST : 1;
    if (wanted.lengthSq() > 0) wanted.normalize().multiplyScalar(this.speed * fast);
    // accelerate and decelerate within a tenth of a second
    this.velocity.lerp(wanted, 1 - Math.exp(-seconds * 14));
    if (this.velocity.length() < this.speed * 0.01) {
      this.velocity.set(0, 0, 0);
      return false;
    }
    view.position.addScaledVector(this.velocity, seconds);
    this.taken();
    return true;
  }

  private taken(): void {
    this.onTaken();
    this.stage.invalidate();
  }
}
