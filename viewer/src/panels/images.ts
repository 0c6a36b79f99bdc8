import type { Connection } from "../connection/connection";
import type { Components } from "../model/components";
import type { Session } from "../model/session";
import type { Watching } from "../model/watching";
import { h } from "../ui/dom";
import { Signal } from "../ui/signal";
import { PicturePanel } from "./picture";

const KEY = "morse.pictures";
/** Maximum number of panels that a selection opens; fewer in narrow windows. */
const MOST = 4;
const NARROW = 900; // pixels

/** Camera images: a panel each, opened by the user, or by selecting the robot. */
export class Images {
  readonly element = h("div", { class: "images", role: "group", "aria-label": "pictures of cameras" });
  /** names of the cameras whose panels are open */
  readonly open = new Signal<string[]>([]);
  /** whether selecting a robot shows the images of its cameras */
  readonly follows = new Signal(localStorage.getItem(KEY) !== "off");
  private readonly panels = new Map<string, PicturePanel>();
  /** opened by the user, or by the script */
  private readonly chosen = new Set<string>();
  /** closed by the user since the robot was selected */
  private readonly closed = new Set<string>();
  private preferred: string[] = [];
  private robot: string | null = null;
  private capturing = true;

  constructor(
    private readonly connection: Connection,
    private readonly components: Components,
    private readonly watching: Watching,
    private readonly session: Session,
  ) {
    connection.on("picture", (picture) => void this.panels.get(picture.camera)?.show(picture));
    connection.on("capturing", ({ active }) => this.showCapturing(active));
    components.selected.watch(() => this.arrange());
    components.all.watch(() => this.arrange());
    this.follows.watch((follows) => {
      localStorage.setItem(KEY, follows ? "on" : "off");
      this.arrange();
    });
    session.world.watch(() => {
      for (const camera of session.recall<string[]>("cameras") ?? []) this.chosen.add(camera);
      this.arrange();
    });
  }

  /** The cameras that the script selected for display: shown until they are closed. */
  prefer(cameras: string[]): void {
    for (const camera of cameras) if (!this.preferred.includes(camera)) this.show(camera);
    this.preferred = cameras;
  }

  /** Show or hide the image of a camera; without a name, of the selected camera or the first one. */
  toggle(camera: string | null = null): string | null {
    const name = camera ?? this.preferred[0] ?? this.components.cameras[0]?.name ?? null;
    if (name === null) return null;
    if (this.panels.has(name)) this.hide(name);
    else this.show(name);
    return name;
  }

  /** Start or stop capturing of all cameras. */
  capture(): void {
    this.connection.send({ type: "toggle_capturing" });
  }

  private show(camera: string): void {
    this.chosen.add(camera);
    this.keep();
    this.arrange();
  }

  private hide(camera: string): void {
    this.chosen.delete(camera);
    this.closed.add(camera);
    this.keep();
    this.arrange();
  }

  private keep(): void {
    this.session.keep("cameras", [...this.chosen]);
  }

  /** Open and close panels for the chosen cameras, and for those of the selected robot. */
  private arrange(): void {
    const robot = this.components.robotOf(this.components.selected.value);
    if (robot !== this.robot) this.closed.clear();
    this.robot = robot;
    const names = new Set([...this.chosen, ...this.ofSelection().filter((name) => !this.closed.has(name))]);
    for (const [name, { element }] of this.panels) {
      if (names.has(name)) continue;
      element.remove();
      this.panels.delete(name);
    }
    for (const name of names) if (!this.panels.has(name)) this.add(name);
    this.open.set([...names]);
    this.watching.set("images", "images", [...names]);
  }

  /** The cameras of the selection: a camera itself, or those of the robot. */
  private ofSelection(): string[] {
    const selected = this.components.selected.value;
    if (!this.follows.value || selected === null) return [];
    const { cameras } = this.components;
    if (cameras.some(({ name }) => name === selected)) return [selected];
    const carried = cameras.filter(({ robot }) => robot === this.robot && robot !== "").map(({ name }) => name);
    return carried.slice(0, innerWidth < NARROW ? 1 : MOST);
  }

  private add(camera: string): void {
    const panel = new PicturePanel(camera, this.components.colorOf(camera), {
      hold: () => this.capture(),
      close: () => this.hide(camera),
    });
    panel.showCapturing(this.capturing);
    this.panels.set(camera, panel);
    this.element.append(panel.element);
  }

  private showCapturing(active: boolean): void {
    this.capturing = active;
    this.element.classList.toggle("stopped", !active);
    for (const panel of this.panels.values()) panel.showCapturing(active);
  }
}
