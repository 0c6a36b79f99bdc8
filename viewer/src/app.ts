import { Connection } from "./connection/connection";
import type { PoseFrame } from "./connection/frames";
import { samePoses } from "./connection/frames";
import { fetchFile } from "./connection/tape";
import type { Appearance, SceneDescription, Viewpoint } from "./generated/protocol";
import { Accidents } from "./input/accidents";
import { Pad } from "./input/gamepad";
import { Keyboard } from "./input/keyboard";
import { Shortcuts } from "./input/shortcuts";
import { Components } from "./model/components";
import { Session } from "./model/session";
import { Watching } from "./model/watching";
import { Clock } from "./panels/clock";
import { Listener } from "./panels/listener";
import { SeatPanel } from "./panels/seat";
import { Toasts } from "./panels/toasts";
import { Panels } from "./panels/panels";
import { Shell } from "./ui/shell";
import { Signal } from "./ui/signal";
import { Follow } from "./view/follow";
import { CameraMemory } from "./view/memory";
import { Navigation } from "./view/navigation";
import { isGround } from "./view/ground";
import { pick } from "./view/pick";
import { Stage } from "./view/stage";
import { Air } from "./world/air";
import { World } from "./world/world";

/** Near clipping distance: nearer objects are always drawn, m. */
const NEAREST = 0.1;

/** The page: the objects that its parts share. */
export class App {
  readonly connection = new Connection();
  readonly shell = new Shell();
  readonly stage = this.makeStage();
  readonly keyboard = new Keyboard(this.connection);
  readonly shortcuts = new Shortcuts();
  readonly navigation = new Navigation(this.stage, this.keyboard);
  readonly follow = new Follow(this.stage);
  readonly memory = new CameraMemory(this.stage);
  readonly session = new Session();
  readonly toasts = new Toasts();
  readonly clock = new Clock(this.connection);
  readonly seat = new SeatPanel(this.connection, () => this.keyboard.release());
  readonly listener = new Listener(this.connection);
  readonly components = new Components(this.connection);
  readonly watching = new Watching(this.connection);
  readonly world = new Signal<World | null>(null);
  readonly poses = new Signal<PoseFrame | null>(null);
  readonly air = new Air(this.connection, this.stage, this.poses);
  readonly panels = new Panels(this);
  readonly pad = new Pad(this.connection);
  readonly accidents = new Accidents(this.keyboard, this.stage.renderer.domElement);
  /** the camera pose that services have set since the world was described */
  private viewpoint: Viewpoint | null = null;
  private loading = Promise.resolve();
  /** the simulator knows that this page has drawn the world */
  private announced = false;
  /** changes since the world was described, applied to a world that is loaded later */
  private readonly appearances = new Map<string, Appearance>();

  constructor() {
    this.navigation.onTaken = () => {
      this.follow.release();
      this.memory.take();
    };
    this.navigation.onClick = (x, y, more) => {
      if (!this.panels.ruler.click(x, y)) this.select(x, y, more);
    };
    this.keyboard.drives = () => this.seat.drives.value;
    this.keyboard.onArrow = () => {
      if (this.listener.robots.value.length === 0) this.toasts.show("No robot obeys the arrow keys: add the actuator Keyboard to one.");
    };
    this.seat.drives.watch((drives) => {
      this.clock.enable(drives);
      this.listener.enable(drives);
    });
    this.connection.on("world", ({ url }) => {
      // one after another: the last one is applied last
      this.shell.view.ariaBusy = "true";
      this.loading = this.loading
        .then(() => this.load(url))
        .catch((error: unknown) => this.toasts.show(String(error), "error"))
        .finally(() => (this.shell.view.ariaBusy = "false"));
    });
    this.connection.on("viewpoint", (viewpoint) => this.moveHome(viewpoint));
    this.components.selected.watch((name) => this.session.keep("selected", name));
    this.connection.on("appearance", (message) => {
      this.appearances.set(message.node, message);
      this.change(message);
    });
    this.connection.on("refused", ({ why }) => this.toasts.show(why, "error"));
    this.connection.on("welcome", ({ title }) => {
      this.announced = false;
      document.title = title;
      this.appearances.clear(); // valid changes are sent again
    });
    this.connection.onPoses = (frame) => this.take(frame);
    this.stage.onDrawn(() => {
      this.connection.drawn();
      if (this.announced || !this.stage.world) return;
      this.announced = true;
      this.connection.send({ type: "shown" });
    });
    this.stage.start();
  }

  /** Initialising the graphics card takes a while: the world is requested before. */
  private makeStage(): Stage {
    this.connection.open();
    try {
      return new Stage(this.shell.view);
    } catch (error) {
      this.connection.close();
      throw error;
    }
  }

  tell(text: string): void {
    this.toasts.show(text);
  }

  private select(x: number, y: number, more: boolean): void {
    const hit = pick(this.stage, x, y);
    if (hit && this.stage.world && isGround(hit, this.stage.world)) {
      this.components.choose(null, more);
      return;
    }
    const owner = hit?.node.find(({ description }) => description.kind !== "");
    // of an object the whole, which is what the tree lists and what is moved
    this.components.choose((owner ?? hit?.node.find(({ parent }) => parent === null))?.name ?? null, more);
  }

  private change(message: Appearance): void {
    const { world } = this.stage;
    if (!world) return;
    world.change(message);
    if (message.light) this.stage.relight();
    this.stage.invalidate();
  }

  private take(frame: PoseFrame): void {
    this.clock.show(frame);
    const still = this.poses.value !== null && samePoses(this.poses.value, frame);
    const known = this.stage.world?.apply(frame) ?? false;
    this.poses.set(frame);
    if (known && !still) this.stage.invalidate();
    else this.connection.drawn();
  }

  private async load(url: string): Promise<void> {
    const answer = await fetchFile(url);
    if (!answer.ok) throw new Error(`The world cannot be fetched: ${answer.status} ${answer.statusText}`);
    const description = (await answer.json()) as SceneDescription;
    const world = await World.load(description, this.stage.surfaces, this.stage.invalidate);
    for (const message of this.appearances.values()) world.change(message);
    const earlier = this.stage.world?.description.key === description.key ? this.stage.world : null;
    if (earlier) world.continue(earlier);
    const unlit = this.stage.show(world);
    if (unlit.length > 0) this.tell(`${unlit.length} lamps are not shown: ${unlit.slice(0, 5).join(", ")}`);
    if (!earlier) this.setCamera(description, world);
    if (!earlier) this.begin(description);
    if (this.poses.value) world.apply(this.poses.value);
    this.world.set(world);
    this.stage.invalidate();
  }

  /** A world is shown for the first time since the page was loaded: restore what was shown of it before. */
  private begin({ key, view }: SceneDescription): void {
    this.session.world.set(key);
    if (this.session.recall("begun") === null) this.panels.display(view.display);
    this.session.keep("begun", true);
    const selected = this.session.recall<string>("selected");
    if (selected !== null && this.components.selected.value === null) this.components.selected.set(selected);
  }

  /** A service has moved the camera of the script: move there, and use it as home. */
  private moveHome(viewpoint: Viewpoint): void {
    // sent again after a lost connection: the user may have moved the camera since
    if (JSON.stringify(viewpoint) === JSON.stringify(this.viewpoint)) return;
    const first = this.viewpoint === null && this.stage.world === null;
    this.viewpoint = viewpoint;
    if (first) return; // part of the world
    const { location, rotation, clip } = viewpoint;
    this.follow.release();
    this.stage.view.position.set(...location);
    this.stage.view.setRotation(rotation);
    this.stage.view.setClip(Math.min(clip[0], NEAREST), Math.max(clip[1], this.stage.view.camera.far));
    this.follow.setHome();
    this.stage.invalidate();
  }

  private setCamera({ view, key }: SceneDescription, world: World): void {
    const bounds = world.bounds();
    // objects of the world beyond the clip distance of the script are drawn nevertheless
    const far = Math.max(view.camera_clip[1], 4 * (bounds.radius + bounds.center.length()), 400);
    this.stage.view.setLens(view.camera_focal_length, Math.min(view.camera_clip[0], NEAREST), Math.min(far, 5000));
    this.stage.view.position.set(...(this.viewpoint?.location ?? view.camera_location));
    this.stage.view.setRotation(this.viewpoint?.rotation ?? view.camera_rotation);
    this.navigation.speed = view.camera_speed;
    // nothing has moved yet: the distance from the followed node is that of the script
    this.follow.setHome(world.find(view.display.follow));
    const kept = this.memory.recall(key);
    if (kept) this.stage.view.pose = kept;
    else this.follow.goHome();
  }
}
