import { Vector3 } from "three";
import type { Connection } from "../connection/connection";
import type { Components } from "../model/components";
import type { Watching } from "../model/watching";
import { h } from "../ui/dom";
import type { Signal } from "../ui/signal";
import type { Stage } from "../view/stage";
import type { World } from "../world/world";
import { Cones } from "./cones";
import { Contacts } from "./contacts";
import { Frames } from "./frames";
import { Frustums } from "./frustums";
import type { Layer, Surroundings } from "./layer";
import { Masses } from "./masses";
import { Names } from "./names";
import { Pin } from "./pin";
import { Rays } from "./rays";
import { Shapes } from "./shapes";
import { Trails } from "./trails";

const KEY = "morse.layers";
const CONTACTS = "contacts";
/** Maximum number of robots with rays and cones: the selected one, and those nearest to the camera. */
const MOST_ROBOTS = 8;
/** ms between two searches for the nearest robots */
const LOOK = 1000;

/** All overlays of the world, and their menu. */
export class Layers {
  readonly element = h("fieldset", { class: "layers" }, h("legend", {}, "show"));
  readonly names: Names;
  readonly list: Layer[];
  private readonly rays: Rays;
  private readonly frustums: Frustums;
  private readonly cones: Cones;
  private readonly boxes = new Map<string, HTMLInputElement>();
  /** sensors whose rays the script shows */
  private declared: string[] = [];
  private hidden = false;
  private readonly note = h("p", { class: "quiet", hidden: true });

  constructor(
    connection: Connection,
    private readonly stage: Stage,
    private readonly components: Components,
    private readonly watching: Watching,
    world: Signal<World | null>,
  ) {
    this.names = new Names(stage);
    this.rays = new Rays(connection, stage.invalidate);
    this.frustums = new Frustums(connection, stage.invalidate);
    this.cones = new Cones(connection, stage.invalidate);
    new Pin(stage, components);
    this.list = [
      this.rays,
      this.frustums,
      this.cones,
      new Trails(),
      this.names,
      new Frames(),
      new Contacts(connection, stage.invalidate),
      new Masses(connection),
      new Shapes(),
    ];
    const kept = new Set(JSON.parse(localStorage.getItem(KEY) ?? "[]") as string[]);
    for (const layer of this.list) {
      layer.install(stage.scene);
      layer.switch(kept.has(layer.id), null);
      this.addBox(layer.id, layer.label, layer.on, (on) => this.switch(layer.id, on));
    }
    this.addBox("grid", "grid", false, (on) => {
      stage.grid = on;
      stage.invalidate();
    });
    world.watch((now) => now && this.rebuild(now));
    components.all.watch(() => this.tell());
    components.selected.watch(() => this.tell());
    stage.onDraw(() => this.update());
    this.element.append(this.note);
    setInterval(() => this.tell(), LOOK);
  }

  switch(id: string, on: boolean): void {
    if (id === "rays") this.hidden = !on;
    this.set(id, on);
    localStorage.setItem(KEY, JSON.stringify(this.list.filter((one) => one.on).map((one) => one.id)));
    this.tell();
    this.stage.invalidate();
  }

  /** Switch an overlay for this world alone: the page does not remember it. */
  set(id: string, on: boolean): void {
    this.list.find((one) => one.id === id)?.switch(on, this.around());
    const box = this.boxes.get(id);
    if (box) box.checked = on;
  }

  private rebuild(world: World): void {
    if (world.description.view.show_physics && !this.list.some(({ id, on }) => id === "shapes" && on)) this.switch("shapes", true);
    for (const layer of this.list) if (layer.on || this.ofSelected(layer)) layer.switch(layer.on, this.around());
  }

  /** The sensors whose rays a script shows. */
  declare(rays: string[]): void {
    this.declared = rays;
    this.tell();
  }

  /** Sensors whose rays the script shows, although those of all sensors are not shown; none once the user has hidden rays. */
  private asked(): string[] {
    const arcs = this.components.all.value.filter(({ properties }) =>
      properties.some(({ name, value }) => name === "Visible_arc" && value === true),
    );
    return this.hidden ? [] : [...this.declared, ...arcs.map(({ name }) => name)];
  }

  /** Whether an overlay is shown at the selected sensor although it is off. */
  private ofSelected(layer: Layer): boolean {
    return layer === this.frustums || layer === this.cones;
  }

  private update(): void {
    const around = this.around();
    if (around) for (const layer of this.list) if (layer.on || this.ofSelected(layer)) layer.update(around);
  }

  private around(): Surroundings | null {
    return this.stage.world && { world: this.stage.world, components: this.components };
  }

  /** Rays and cones of some robots: those of many robots would fill the view and the connection. */
  private tell(): void {
    const on = (id: string): boolean => this.list.some((layer) => layer.id === id && layer.on);
    const all = this.components.all.value;
    const robots = all.filter(({ kind }) => kind.includes("robot")).map(({ name }) => name);
    const near = this.nearest(robots);
    const any = on("rays") || on("cones") || on("frustums");
    this.note.hidden = near.size === robots.length || !any;
    this.note.textContent = `Rays, cones and fields of view of ${near.size} of ${robots.length} robots: the selected one, and those nearest to the camera.`;
    const shown = all.filter(({ kind, robot }) => kind === "sensor" && near.has(robot)).map(({ name }) => name);
    const selected = all.filter(({ kind, name }) => kind === "sensor" && name === this.components.selected.value).map(({ name }) => name);
    const asked = this.asked();
    const sensors = [...(any ? shown : []), ...asked, ...selected];
    this.rays.keep([...(on("rays") ? shown : []), ...asked, ...selected]);
    this.frustums.keep([...(on("frustums") ? shown : []), ...selected]);
    this.cones.keep([...(on("cones") ? shown : []), ...selected]);
    const box = this.boxes.get("rays");
    if (box) box.indeterminate = asked.length > 0 && !on("rays");
    this.watching.set("overlays", "layers", on(CONTACTS) ? [...sensors, CONTACTS] : sensors);
  }

  private nearest(robots: string[]): Set<string> {
    const { world, view } = this.stage;
    if (robots.length <= MOST_ROBOTS || !world) return new Set(robots.slice(0, MOST_ROBOTS));
    const chosen = this.components.robotOf(this.components.selected.value);
    const place = new Vector3();
    const far = (name: string): number =>
      name === chosen ? -1 : (world.find(name)?.frame.getWorldPosition(place).distanceTo(view.position) ?? Infinity);
    const sorted = robots.map((name): [string, number] => [name, far(name)]).sort(([, a], [, b]) => a - b);
    return new Set(sorted.slice(0, MOST_ROBOTS).map(([name]) => name));
  }

  private addBox(id: string, label: string, checked: boolean, run: (on: boolean) => void): void {
    const box = h("input", { type: "checkbox", checked, onchange: () => run(box.checked) });
    this.boxes.set(id, box);
    this.element.append(h("label", { class: "switch" }, box, label));
  }
}
