import type { Vector3 } from "three";
import type { Connection } from "../connection/connection";
import type { Answer, Model, SceneChanges } from "../generated/protocol";
import type { Components } from "../model/components";
import type { Toasts } from "../panels/toasts";
import { disable, h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import type { Shell } from "../ui/shell";
import type { Signal } from "../ui/signal";
import { newGroup } from "../view/mover";
import type { Hit } from "../view/pick";
import type { Stage } from "../view/stage";
import type { World } from "../world/world";
import { AddPanel } from "./addpanel";
import { Marker } from "./marker";
import { confirmSave } from "./savedialog";
import { ScriptPanel } from "./script";
import type { Add } from "./upload";
import { Uploader } from "./upload";

/** Adds and deletes robots, objects and components, undoes changes, and saves the scene. */
export class Editor {
  readonly element: HTMLElement;
  readonly list: AddPanel;
  readonly script: ScriptPanel;
  readonly uploader: Uploader;
  private readonly marker: Marker;
  private readonly addButton: HTMLButtonElement;
  private readonly undoButton: HTMLButtonElement;
  private readonly redoButton: HTMLButtonElement;
  private readonly saveButton = h("button", { type: "button", class: "save", onclick: () => void this.save() }, "save…");
  private readonly seatHint = h("p", { class: "quiet", hidden: true }, "Only the page that drives can change the scene: ask to drive (above).");

  constructor(
    private readonly connection: Connection,
    private readonly stage: Stage,
    private readonly components: Components,
    private readonly toasts: Toasts,
    private readonly shell: Shell,
    private readonly world: Signal<World | null>,
    private readonly drives: Signal<boolean>,
    /** what the list of models takes the place of */
    private readonly tree: HTMLElement,
    compare: (file: File) => void,
  ) {
    this.marker = new Marker(stage);
    const add: Add = (kind, name, place) => this.put({ kind, name, group: "robots", doc: "", words: "" }, place);
    this.uploader = new Uploader(connection, toasts, drives, add, compare);
    this.list = new AddPanel(connection, {
      show: (_, x, y) => this.aim(x, y),
      put: (model, place) => void this.put(model, place),
      cancel: () => this.release(),
    }, this.uploader.element);
    this.script = new ScriptPanel(connection, components, toasts, drives);
    const scriptButton = iconButton(icons.code, "Script", () => this.showScript());
    this.addButton = h("button", { type: "button", class: "add", "aria-pressed": "false", onclick: () => this.toggle() });
    this.addButton.innerHTML = icons.plus;
    this.addButton.append("add");
    this.undoButton = iconButton(icons.undo, "Undo", () => void this.undo(), "Ctrl+Z");
    this.redoButton = iconButton(icons.redo, "Redo", () => void this.redo(), "Ctrl+Y");
    this.element = h(
      "div",
      { class: "editor", hidden: true },
      h("div", { class: "tools" }, this.addButton, this.undoButton, this.redoButton, scriptButton, this.saveButton),
      this.seatHint,
    );
    // a recorded run has none
    connection.on("welcome", () => (this.element.hidden = true));
    connection.on("scene_changes", (changes) => this.show(changes));
    drives.watch((drives) => {
      this.seatHint.hidden = drives;
      this.enable();
      if (!drives) this.close();
    });
  }

  private changes: SceneChanges | null = null;

  /** Who may not change the scene sees disabled controls. */
  private enable(): void {
    const drives = this.drives.value;
    for (const button of [this.addButton, this.undoButton, this.redoButton, this.saveButton]) disable(button, !drives);
    this.undoButton.disabled ||= !this.changes?.last;
    this.redoButton.disabled ||= !this.changes?.next;
    this.saveButton.disabled ||= !this.changes?.file;
  }

  private show(changes: SceneChanges): void {
    const { count, last, next, file } = changes;
    this.changes = changes;
    this.element.hidden = false;
    this.undoButton.title = last === "" ? "Nothing to undo" : `Undo: ${last} (Ctrl+Z)`;
    this.redoButton.title = next === "" ? "Nothing to redo" : `Redo: ${next} (Ctrl+Y)`;
    this.saveButton.hidden = count === 0;
    this.saveButton.title = file === "" ? "A program describes this scene: there is no script to save it in" : `Save in ${file} (Ctrl+S)`;
    this.saveButton.textContent = `save ${count}…`;
    this.saveButton.setAttribute("aria-label", `save ${count} ${count === 1 ? "change" : "changes"}`);
    this.enable();
  }

  toggle(): void {
    if (this.list.element.hidden) {
      this.tree.hidden = true;
      this.addButton.setAttribute("aria-pressed", "true");
      this.list.open();
    } else this.close();
  }

  private showScript(): void {
    if (this.shell.bottom.hidden || this.script.element.hidden) this.shell.show("bottom");
    void this.script.toggle();
  }

  private close(): void {
    this.list.close();
    this.tree.hidden = false;
    this.addButton.setAttribute("aria-pressed", "false");
  }

  /** Add a model; returns whether that was possible. */
  private async put(model: Model, place: { x: number; y: number } | null): Promise<boolean> {
    const frame = this.stage.renderer.domElement.getBoundingClientRect();
    const over = place && document.elementFromPoint(place.x, place.y);
    this.release();
    if (place && over !== this.stage.renderer.domElement) return false; // dropped on a panel: not meant for the world
    const { x, y } = place ?? { x: frame.left + frame.width / 2, y: frame.top + frame.height / 2 };
    const { point, hit } = this.marker.point(x, y);
    this.marker.hide();
    const mounted = isMounted(model);
    const carrier = mounted ? this.carrier(hit, place === null) : null;
    if (mounted && !carrier) {
      const kind = model.group.slice(0, -1);
      this.toasts.show(`Select the robot that gets the ${kind} first, or drop the ${kind} onto it.`, "error");
      return false;
    }
    const { robot, position, normal } = carrier ?? { robot: "", position: point, normal: null };
    const answer = await this.connection.request({
      type: "add_model",
      model: model.kind,
      position: position?.toArray() ?? null,
      yaw: 0,
      robot,
      normal: normal?.toArray() ?? null,
      beside: place === null,
    });
    if (!answer.ok) this.toasts.show(answer.error, "error");
    else {
      const name = String(answer.value);
      this.select([name]);
      if (robot) this.toasts.show(`${name} is on ${name.slice(0, name.lastIndexOf("."))}.`);
      else if (this.shell.narrow) this.toasts.show(`${name} is in the world.`); // the list covers it
    }
    // the list stays open for the next model, unless one looks at where this one was dropped
    if (place && this.shell.narrow && !this.shell.left.hidden) this.shell.toggle("left");
    return answer.ok;
  }

  private aim(x: number, y: number): void {
    this.shell.left.classList.toggle("away", this.shell.narrow);
    this.marker.point(x, y);
  }

  private release(): void {
    this.shell.left.classList.remove("away");
    this.marker.hide();
  }

  /** Select objects as soon as they are in the world. */
  private select(names: string[]): void {
    if (names.length === 0) return;
    const stop = this.world.watch((world) => {
      if (!names.every((name) => world?.find(name))) return;
      names.forEach((name, i) => this.components.choose(name, i > 0));
      queueMicrotask(() => stop());
    });
  }

  /** The surface of a robot, an arm or a pan-tilt unit at a point; without a point, what is selected, or the only robot. */
  private carrier(hit: Hit | null, selected: boolean): { robot: string; position: Vector3 | null; normal: Vector3 | null } | null {
    if (selected) {
      const robots = this.components.all.value.filter(({ kind }) => kind === "robot");
      const chosen = this.components.selected.value;
      const robot = this.components.robotOf(chosen) ? chosen : robots.length === 1 ? robots[0]?.name : null;
      return robot ? { robot, position: null, normal: null } : null;
    }
    const isOnRobot = hit?.node.find(({ description }) => description.kind === "robot");
    return hit && isOnRobot ? { robot: hit.node.name, position: hit.point, normal: hit.normal } : null;
  }

  /** Delete objects together: one undo brings all of them back. */
  async delete(names: string[]): Promise<void> {
    const group = newGroup();
    // a component goes with its robot
    const wholes = names.filter((name) => !names.some((other) => name.startsWith(`${other}.`)));
    const answers = await Promise.all(wholes.map((node) => this.connection.request({ type: "delete_object", node, group })));
    this.complain(answers);
    const gone = wholes.filter((_, i) => answers[i]?.ok);
    if (gone.includes(this.components.selected.value ?? "")) this.components.selected.set(null);
    else this.components.also.set(this.components.also.value.filter((name) => !gone.includes(name)));
  }

  async duplicate(names: string[]): Promise<void> {
    if (names.length === 0 || this.element.hidden) return;
    const group = newGroup();
    const answers = await Promise.all(names.map((node) => this.connection.request({ type: "duplicate_object", node, group })));
    this.complain(answers);
    this.select(answers.filter(({ ok }) => ok).map(({ value }) => String(value)));
  }

  /** Multiply sizes; returns whether that was possible. */
  async scale(names: string[], factors: [number, number, number], group: number): Promise<boolean> {
    const answers = await Promise.all(names.map((node) => this.connection.request({ type: "scale_object", node, factors, group })));
    this.complain(answers);
    return answers.every(({ ok }) => ok);
  }

  private complain(answers: Answer[]): void {
    for (const error of new Set(answers.filter(({ ok }) => !ok).map((answer) => answer.error))) this.toasts.show(error, "error");
  }

  async redo(): Promise<void> {
    if (this.element.hidden) return;
    const answer = await this.connection.request({ type: "redo_change" });
    this.toasts.show(answer.ok ? `Made again: ${String(answer.value)}.` : answer.error, answer.ok ? "info" : "error");
  }

  async undo(): Promise<void> {
    if (this.element.hidden) return;
    const answer = await this.connection.request({ type: "undo_change" });
    this.toasts.show(answer.ok ? `Undone: ${String(answer.value)}.` : answer.error, answer.ok ? "info" : "error");
  }

  async save(): Promise<void> {
    if (this.element.hidden || this.saveButton.hidden) return;
    const shown = await this.connection.request({ type: "save_scene", write: false });
    if (!shown.ok) {
      this.toasts.show(shown.error, "error");
      return;
    }
    const { path, difference, folders } = shown.value as { path: string; difference: string; folders: string[] };
    confirmSave(path, difference, folders, () => void this.write(path));
  }

  private async write(path: string): Promise<void> {
    const answer = await this.connection.request({ type: "save_scene", write: true });
    this.toasts.show(answer.ok ? `Saved in ${path}.` : answer.error, answer.ok ? "info" : "error");
  }
}

/** Whether a model is a part of a robot. */
function isMounted({ group }: Model): boolean {
  return group === "sensors" || group === "actuators";
}
