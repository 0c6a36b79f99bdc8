import type { Connection } from "../connection/connection";
import type { ComponentDescription } from "../generated/protocol";
import { Signal } from "../ui/signal";
import { colorOf } from "../ui/colors";

export interface Live {
  time: number;
  data: Record<string, unknown>;
  /** why the data are incomplete, or what they are */
  note: string;
}

/** The last problem of a component. */
export interface Complaint {
  level: "warning" | "error";
  text: string;
}

/** The components of the simulation, their values, and the one that is selected. */
export class Components {
  readonly all = new Signal<ComponentDescription[]>([]);
  /** name of a component or of an object of the world */
  readonly selected = new Signal<string | null>(null);
  /** what is selected beside it, and moved, duplicated and deleted together with it */
  readonly also = new Signal<string[]>([]);
  readonly complaints = new Map<string, Complaint>();
  private readonly live = new Map<string, Live>();
  private readonly listeners = new Set<(name: string, live: Live) => void>();
  private readonly changed = new Set<(component: ComponentDescription) => void>();

  constructor(connection: Connection) {
    this.selected.watch(() => this.also.set([]));
    // the log is sent after this, if there is one
    connection.on("welcome", () => this.complaints.clear());
    connection.on("tree", ({ components }) => {
      // who acts again has been mended, or begins anew
      for (const { name, active } of components) if (active) this.complaints.delete(name);
      this.all.set(components);
    });
    connection.on("values", ({ component, time, data, note }) => {
      const live = { time, data, note };
      this.live.set(component, live);
      for (const listener of this.listeners) listener(component, live);
    });
    connection.on("property_value", ({ component, name, value }) => {
      this.patch(component, (one) => ({
        ...one,
        properties: one.properties.map((property) => (property.name === name ? { ...property, value } : property)),
      }));
    });
    connection.on("activity", ({ component, active }) => this.patch(component, (one) => ({ ...one, active })));
  }

  find(name: string | null): ComponentDescription | null {
    return this.all.value.find((component) => component.name === name) ?? null;
  }

  /** All that is selected; the last one is that whose details are shown. */
  get chosen(): string[] {
    return this.selected.value === null ? [] : [...this.also.value, this.selected.value];
  }

  /** Select something alone, or add it to what is selected, or take it from there. */
  choose(name: string | null, more: boolean): void {
    const before = this.chosen;
    const now = !more ? [] : before.filter((one) => one !== name);
    if (name !== null && !(more && before.includes(name))) now.push(name);
    if (more && name === null) return;
    this.selected.set(now.at(-1) ?? null);
    this.also.set(now.slice(0, -1));
  }

  /** The robot that a component belongs to. */
  robotOf(name: string | null): string | null {
    const component = this.find(name);
    return component ? component.robot || null : null;
  }

  /** The sensors that capture images. */
  get cameras(): ComponentDescription[] {
    return this.all.value.filter(isCamera);
  }

  /** The colour of a camera on the whole page. */
  colorOf(camera: string): string {
    return colorOf(Math.max(this.cameras.findIndex(({ name }) => name === camera), 0));
  }

  valuesOf(name: string): Live | null {
    return this.live.get(name) ?? null;
  }

  onValues(listener: (name: string, live: Live) => void): void {
    this.listeners.add(listener);
  }

  /** A property, the activity or a complaint of a component changed. */
  onChange(listener: (component: ComponentDescription) => void): void {
    this.changed.add(listener);
  }

  /** Report a problem; a warning does not replace an error. */
  complain(name: string, level: Complaint["level"], text: string): void {
    if (level === "warning" && this.complaints.get(name)?.level === "error") return;
    this.complaints.set(name, { level, text });
    this.patch(name, (one) => one);
  }

  private patch(name: string, change: (component: ComponentDescription) => ComponentDescription): void {
    const index = this.all.value.findIndex((component) => component.name === name);
    const old = this.all.value[index];
    if (!old) return;
    const changed = change(old);
    // in place: the tree is rebuilt only when components are added or removed
    this.all.value[index] = changed;
    for (const listener of this.changed) listener(changed);
  }
}

/** Whether a component has pictures: a camera, or a sensor that shows its data as one. */
export function isCamera({ kind, pictured }: ComponentDescription): boolean {
  return kind === "sensor" && pictured;
}
