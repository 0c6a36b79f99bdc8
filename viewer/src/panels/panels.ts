import { tape } from "../connection/tape";
import type { App } from "../app";
import type { DisplayDescription } from "../generated/protocol";
import { Layers } from "../layers/layers";
import { disable, h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import { isCamera } from "../model/components";
import { Sounds } from "../sound/sounds";
import { Editor } from "../editor/editor";
import { theme, toggleTheme } from "../ui/theme";
import { Ghost } from "../view/ghost";
import { Highlight } from "../view/highlight";
import { Mover } from "../view/mover";
import type { WorldNode } from "../world/node";
import { Capture } from "./capture";
import { DebugList } from "./debug";
import { Help } from "./help";
import { HistoryPanel } from "./history";
import { camerasMenu } from "./camerasmenu";
import { Images } from "./images";
import { Inspector } from "./inspector";
import { LinkBanner } from "./link";
import { LogPanel } from "./log";
import { MoreButton } from "./more";
import { ObjectPanel } from "./object";
import type { Plot } from "./plot";
import { PlotsPanel } from "./plots";
import { Rate } from "./rate";
import { RecordingPanel } from "./recording";
import { Ruler } from "./ruler";
import { SavedPanel } from "./saved";
import { TaskPanel } from "./task";
import { TouchPad } from "./touchpad";
import { TreePanel } from "./tree";
import { ViewMenu } from "./viewmenu";
import { WorldEnd } from "./worldend";

/** All panels with their positions and shortcuts. */
export class Panels {
  readonly help: Help;
  readonly capture: Capture;
  readonly layers: Layers;
  readonly images: Images;
  readonly plots: PlotsPanel;
  readonly object: ObjectPanel;
  readonly mover: Mover;
  readonly ruler: Ruler;
  readonly viewMenu: ViewMenu;
  readonly history: HistoryPanel;
  readonly recording: RecordingPanel;
  readonly sounds: Sounds;
  readonly editor: Editor;
  readonly ghost: Ghost;
  private readonly highlight: Highlight;

  constructor(private readonly app: App) {
    const { connection, stage, components, watching, follow, toasts, shell } = app;
    this.help = new Help(app.shortcuts);
    this.capture = new Capture(stage, toasts);
    this.layers = new Layers(connection, stage, components, watching, app.world);
    this.images = new Images(connection, components, watching, app.session);
    this.plots = new PlotsPanel(components, watching, app.session, () => shell.show("bottom"), (text) => toasts.show(text), tape ? null : () => this.recording.openInFoxglove());
    this.object = new ObjectPanel(stage, follow, this.images, toasts, connection, (node) => this.move(node), () => void this.editor.delete(components.chosen), () => void this.editor.duplicate(components.chosen), app.seat.drives);
    this.mover = new Mover(stage, connection, (movement) => void this.object.teleport(movement), (nodes, factors, group) => void this.editor.scale(nodes.map(({ name }) => name), factors, group));
    this.mover.running = () => app.poses.value?.running ?? false;
    app.navigation.claims = (event) => this.mover.claims(event);
    this.ruler = new Ruler(stage);
    this.viewMenu = new ViewMenu(stage, follow, components, this.layers, camerasMenu(this.images, components), this.ruler.on);
    this.highlight = new Highlight(stage);
    const tree = new TreePanel(components, app.world, (name) => this.focus(name), () => shell.narrow && shell.show("right"));
    const inspector = new Inspector(
      connection,
      components,
      watching,
      app.seat.drives,
      (name) => this.object.show(name, components.cameras.some((camera) => camera.name === name)),
      (component, field) => this.plots.plot(component, field),
    );
    const ghost = (this.ghost = new Ghost(stage, toasts, app.poses));
    this.viewMenu.element.querySelector(".popup")?.append(ghost.button);
    this.editor = new Editor(connection, stage, components, toasts, shell, app.world, app.seat.drives, tree.element, (file) => void ghost.load(file));
    shell.left.append(this.editor.element, this.editor.list.element, tree.element);
    shell.right.append(inspector.element);
    const openLog = (text: string): void => {
      shell.show("bottom");
      log.reveal(text);
    };
    const log: LogPanel = new LogPanel(connection, components, toasts, (level) => (level === "error" ? shell.offer("bottom") : shell.flag("bottom", level)), openLog);
    const saved = new SavedPanel(connection, ({ file, text }) => openLog(text || file));
    shell.bottom.append(this.editor.script.element, this.plots.element, log.tab, log.element);
    this.recording = new RecordingPanel(connection, app.seat.drives, toasts);
    this.sounds = new Sounds(connection, stage, app.poses);
    this.fillHeader();
    shell.over.append(h("div", { class: "said" }, new TaskPanel(connection).element, ghost.element, this.mover.element, this.ruler.element, this.recording.element, app.clock.warning, new WorldEnd(app.world, components).element, new DebugList(connection).element), h("div", { class: "corner" }, this.images.element));
    this.history = new HistoryPanel(connection, app.poses, app.seat.drives);
    const pad = new TouchPad(app.keyboard, app.seat.drives, app.listener.robots);
    // a hand that drives cannot move the camera, and a small picture is left soon
    pad.onDrive = () => {
      const node = stage.world?.find(app.listener.driven ?? "");
      if (node && follow.mode.value === "free") follow.start("along", node);
    };
    shell.view.append(this.layers.names.element, this.history.element, pad.element, new Rate(stage).element, new LinkBanner(connection).element, toasts.element);
    toasts.element.append(saved.element);
    document.body.append(this.help.element);
    components.selected.watch((name) => shell.fill(name !== null));
    const highlight = (): void => this.highlight.show(this.nodesOf(components.chosen));
    components.selected.watch(highlight);
    components.also.watch(highlight);
    app.world.watch((world) => {
      if (!world) return;
      this.images.prefer(world.description.view.display.images);
      this.layers.declare(world.description.view.display.rays);
      highlight();
      this.mover.rebind(world);
      this.object.rebind(world);
      follow.rebind(world);
    });
    this.addShortcuts();
  }

  /** What the script shows when its world is opened for the first time. */
  display({ overlays, plots, panels, select }: DisplayDescription): void {
    const { shell, components } = this.app;
    for (const overlay of overlays) this.layers.set(overlay, true);
    for (const curves of plots) {
      let into: Plot | null = null;
      for (const { component, field } of curves) into = this.plots.plot(component, field, into);
    }
    if (select !== "") components.selected.set(select);
    if (panels) shell.arrange(panels);
    else if (plots.length > 0) shell.show("bottom");
  }

  private fillHeader(): void {
    const { shell, clock, connection, listener, seat, world } = this.app;
    const scene = h("span", { class: "scene" });
    connection.on("welcome", ({ title }) => (scene.textContent = title));
    world.watch((now) => (scene.title = now?.description.environment ?? ""));
    const themeButton = iconButton(icons.moon, "Light or dark", toggleTheme);
    theme.watch((now) => (themeButton.innerHTML = now === "light" ? icons.moon : icons.sun));
    const quitButton = iconButton(icons.power, "End the simulation", () => this.app.clock.quit());
    this.app.seat.drives.watch((drives) => disable(quitButton, !drives));
    quitButton.hidden = tape !== null; // a run in a page has nothing to end
    // rarely used controls: beside the others, or behind a button in narrow windows
    const more = h(
      "div",
      { class: "extra", id: "extra" },
      this.sounds.button,
      this.recording.button,
      ...this.capture.element.children,
      themeButton,
      quitButton,
      iconButton(icons.help, "Keys", () => this.help.toggle(), "H"),
    );
    // one row on a phone, too
    const phone = matchMedia("(max-width: 560px)");
    const arrange = (): void => {
      clock.lend(phone.matches ? more : null);
      if (phone.matches) more.prepend(listener.element);
      else seat.element.before(listener.element);
    };
    shell.header.append(
      shell.toggles.left,
      h("div", { class: "brand" }, h("span", { class: "mark" }), h("h1", {}, "MORSE"), scene),
      clock.element,
      h("div", { class: "space" }),
      listener.element,
      seat.element,
      h(
        "div",
        { class: "tools" },
        this.viewMenu.element,
        shell.toggles.bottom,
        more,
        shell.toggles.right,
        new MoreButton(more).element,
      ),
    );
    phone.addEventListener("change", arrange);
    arrange();
  }

  private addShortcuts(): void {
    const { app } = this;
    const { shortcuts, clock, follow } = app;
    shortcuts.add("Time", ["p", "P"], "P", "play, pause", () => clock.toggle());
    shortcuts.add("Time", ["."], ".", "one tick", () => clock.step());
    shortcuts.add("Time", [","], ",", "go back in time", () => this.history.stepBack());
    shortcuts.add("Time", ["F11"], "F11", "reset everything", () => clock.reset());
    shortcuts.add("Time", ["Space"], "Space", "cameras take pictures, or stop", () => this.images.capture());
    shortcuts.add("View", ["F7"], "F7", "go to the next robot", () => this.nextRobot());
    shortcuts.add("View", ["F8"], "F8", "the initial viewpoint", () => this.goHome());
    shortcuts.add("View", ["F9"], "F9", "next camera of the world", () => app.tell(`Camera: ${follow.nextCamera()}`));
    shortcuts.add("View", ["1"], "1", "follow from behind", () => this.viewMenu.start("third"));
    shortcuts.add("View", ["2"], "2", "view from on board", () => this.viewMenu.start("first"));
    shortcuts.add("View", ["3"], "3", "follow from above", () => this.viewMenu.start("top"));
    shortcuts.add("View", ["4"], "4", "move along, keep the direction", () => this.viewMenu.start("along"));
    shortcuts.add("View", ["5"], "5", "plan: straight down", () => follow.plan());
    shortcuts.add("View", ["b", "B"], "B", "measure with the ruler", () => this.ruler.on.set(!this.ruler.on.value));
    shortcuts.add("View", ["0"], "0", "stop following", () => this.viewMenu.start("free"));
    shortcuts.add("View", ["c", "C"], "C", "show the selected object", () => this.focus(app.components.selected.value));
    shortcuts.add("View", ["v", "V"], "V", "show the image of a robot's camera", () => this.toggleImage());
    shortcuts.add("Page", ["m", "M"], "M", "move the selected object, or stop", () => this.move(this.selectedNode()));
    shortcuts.add("Page", ["n", "N"], "N", "move, turn or scale", () => this.mover.turn());
    shortcuts.add("Page", ["g", "G"], "G", "move in steps", () => this.mover.snaps.set(!this.mover.snaps.value));
    shortcuts.add("Page", ["Delete"], "Del", "delete the selection", () => void this.editor.delete(app.components.chosen));
    shortcuts.add("Page", ["Ctrl+z"], "Ctrl+Z", "undo a change", () => void this.editor.undo());
    shortcuts.add("Page", ["Ctrl+y", "Ctrl+Z"], "Ctrl+Y", "redo a change", () => void this.editor.redo());
    shortcuts.add("Page", ["Ctrl+d"], "Ctrl+D", "duplicate the selection", () => void this.editor.duplicate(app.components.chosen));
    shortcuts.add("Page", ["Ctrl+s"], "Ctrl+S", "save the scene", () => void this.editor.save());
    shortcuts.add("Page", ["x", "X"], "X", "screenshot", () => this.capture.picture());
    shortcuts.add("Page", ["Escape"], "Esc", "select nothing", () => this.escape());
    shortcuts.add("Page", ["h", "H", "?"], "H", "this list", () => this.help.toggle());
  }

  private selectedNode(): WorldNode | null {
    return this.app.stage.world?.find(this.app.components.selected.value ?? "") ?? null;
  }

  private move(node: WorldNode | null): void {
    if (!node && !this.mover.node.value) this.app.tell("Select something first: click it.");
    else if (!this.app.seat.drives.value) this.app.tell("Only the page that drives can move things.");
    else this.mover.toggle(node, this.nodesOf(this.app.components.also.value));
  }

  private nodesOf(names: string[]): WorldNode[] {
    return names.map((name) => this.app.stage.world?.find(name)).filter((node): node is WorldNode => node !== undefined && node !== null);
  }

  private focus(name: string | null): void {
    const node = this.app.stage.world?.find(name ?? "");
    this.app.follow.release();
    if (node) this.app.follow.frameNode(node);
  }

  private nextRobot(): void {
    const robot = this.app.follow.nextRobot();
    this.app.tell(robot?.name ?? "There is no robot.");
  }

  private goHome(): void {
    this.app.memory.forget();
    this.app.follow.goHome();
  }

  private toggleImage(): void {
    const selected = this.app.components.find(this.app.components.selected.value);
    const camera = selected && isCamera(selected) ? selected.name : null;
    if (this.images.toggle(camera) === null) this.app.tell("No robot has a camera.");
  }

  private escape(): void {
    if (this.ruler.on.value) this.ruler.on.set(false);
    else if (this.mover.node.value) this.mover.toggle(null);
    else this.app.components.selected.set(null);
  }
}
