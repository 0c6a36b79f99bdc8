import { Connection } from "./connection/connection";
import type { PoseFrame } from "./connection/frames";
import type { SceneDescription } from "./generated/protocol";
import { Keyboard } from "./input/keyboard";
import { Shortcuts } from "./input/shortcuts";
import { Clock } from "./panels/clock";
import { Help } from "./panels/help";
import { LinkBanner } from "./panels/link";
import { Listener } from "./panels/listener";
import { SeatPanel } from "./panels/seat";
import { Toasts } from "./panels/toasts";
import { h, iconButton } from "./ui/dom";
import { icons } from "./ui/icons";
import { Shell } from "./ui/shell";
import { Signal } from "./ui/signal";
import { theme, toggleTheme } from "./ui/theme";
import { Follow } from "./view/follow";
import { Navigation } from "./view/navigation";
import { Stage } from "./view/stage";
import { World } from "./world/world";

/** The whole page: what its parts have in common. */
export class App {
  readonly connection = new Connection();
  readonly shell = new Shell();
  readonly stage = new Stage(this.shell.view);
  readonly keyboard = new Keyboard(this.connection);
  readonly shortcuts = new Shortcuts();
  readonly navigation = new Navigation(this.stage, this.keyboard);
  readonly follow = new Follow(this.stage);
  readonly toasts = new Toasts();
  readonly help = new Help(this.shortcuts);
  readonly clock = new Clock(this.connection);
  readonly seat = new SeatPanel(this.connection);
  readonly listener = new Listener(this.connection);
  readonly world = new Signal<World | null>(null);
  readonly poses = new Signal<PoseFrame | null>(null);
  private loading = Promise.resolve();

  constructor() {
    this.build();
    this.addShortcuts();
    this.navigation.onTaken = () => this.follow.release();
    this.seat.drives.watch((drives) => {
      this.clock.enable(drives);
      this.listener.enable(drives);
    });
    this.connection.on("world", ({ url }) => {
      // one after another: the last one told is the one that stays
      this.loading = this.loading.then(() => this.load(url)).catch((error: unknown) => this.toasts.show(String(error), "error"));
    });
    this.connection.on("appearance", (message) => {
      this.stage.world?.change(message);
      this.stage.invalidate();
    });
    this.connection.on("refused", ({ why }) => this.toasts.show(why, "error"));
    this.connection.on("welcome", ({ title }) => (document.title = title));
    this.connection.onPoses = (frame) => this.take(frame);
    this.stage.onDrawn(() => this.connection.drawn());
    this.connection.open();
    this.stage.start();
  }

  private build(): void {
    const themeButton = iconButton(icons.moon, "Light or dark", toggleTheme);
    theme.watch((now) => (themeButton.innerHTML = now === "light" ? icons.moon : icons.sun));
    const brand = h("div", { class: "brand" }, h("span", { class: "mark" }), h("b", {}, "MORSE"), h("span", { class: "scene" }));
    this.shell.header.append(
      brand,
      this.clock.element,
      h("div", { class: "space" }),
      this.listener.element,
      this.seat.element,
      themeButton,
      iconButton(icons.help, "Keys", () => this.help.toggle(), "h"),
    );
    this.shell.view.append(new LinkBanner(this.connection).element, this.toasts.element);
    document.body.append(this.help.element);
  }

  private addShortcuts(): void {
    const { shortcuts, clock, follow, connection } = this;
    shortcuts.add("Time", ["p", "P"], "P", "play, pause", () => clock.toggle());
    shortcuts.add("Time", ["."], ".", "one tick", () => clock.step());
    shortcuts.add("Time", ["F11"], "F11", "reset everything", () => clock.reset());
    shortcuts.add("Time", ["Space"], "Space", "cameras take pictures, or stop", () => connection.send({ type: "toggle_capturing" }));
    shortcuts.add("View", ["F7"], "F7", "stand near the next robot", () => this.tell(follow.nextRobot()?.name ?? "There is no robot."));
    shortcuts.add("View", ["F8"], "F8", "where the script put the camera", () => follow.goHome());
    shortcuts.add("View", ["F9"], "F9", "next camera of the world", () => this.tell(`Camera: ${follow.nextCamera()}`));
    shortcuts.add("Page", ["h", "H", "?"], "h", "this list", () => this.help.toggle());
  }

  tell(text: string): void {
    this.toasts.show(text);
  }

  private take(frame: PoseFrame): void {
    this.clock.show(frame);
    const known = this.stage.world?.apply(frame) ?? false;
    this.poses.set(frame);
    if (known) this.stage.invalidate();
    else this.connection.drawn();
  }

  private async load(url: string): Promise<void> {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`The world cannot be fetched: ${answer.status} ${answer.statusText}`);
    const description = (await answer.json()) as SceneDescription;
    const first = this.stage.world?.description.key !== description.key;
    const anisotropy = this.stage.renderer.capabilities.getMaxAnisotropy();
    const world = await World.load(description, Math.min(8, anisotropy), this.stage.invalidate);
    const unlit = this.stage.show(world);
    if (unlit.length > 0) this.tell(`${unlit.length} lamps are not shown: ${unlit.slice(0, 5).join(", ")}`);
    if (first) this.setCamera(description, world);
    if (this.poses.value) world.apply(this.poses.value);
    const scene = this.shell.header.querySelector(".scene");
    if (scene) scene.textContent = description.environment;
    this.world.set(world);
    this.stage.invalidate();
  }

  private setCamera({ view }: SceneDescription, world: World): void {
    const bounds = world.bounds();
    // what the script made too short for its own world is drawn all the same
    const far = Math.max(view.camera_clip[1], 4 * (bounds.radius + bounds.center.length()), 400);
    this.stage.view.setLens(view.camera_focal_length, Math.min(view.camera_clip[0], 0.1), Math.min(far, 5000));
    this.stage.view.position.set(...view.camera_location);
    this.stage.view.setRotation(view.camera_rotation);
    this.navigation.speed = view.camera_speed;
    this.follow.setHome();
  }
}
