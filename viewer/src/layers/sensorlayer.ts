import type { DisplayDescription } from "../generated/protocol";
import type { Surroundings } from "./layer";
import { Layer, discard } from "./layer";

/** An overlay that is drawn at sensors: at all of them if it is on, and at the selected one. */
export abstract class SensorLayer<M extends { component: string }> extends Layer {
  private readonly known = new Map<string, M>();
  private around: Surroundings | null = null;
  private shown: string[] = [];

  constructor(
    id: DisplayDescription["overlays"][number],
    label: string,
    private readonly changed: () => void,
  ) {
    super(id, label);
  }

  /** Draw the overlay of one sensor, in place of an earlier one. */
  abstract draw(message: M, around: Surroundings): void;

  protected take(message: M): void {
    this.known.set(message.component, message);
    if (!this.around) return;
    this.draw(message, this.around);
    this.changed();
  }

  protected shows(component: string): boolean {
    return this.shown.includes(component);
  }

  /** The sensors whose overlay is shown, also if the overlay of all sensors is off. */
  keep(components: string[]): void {
    this.shown = components;
    for (const child of [...this.root.children]) if (!components.includes(child.name)) discard(child);
    if (!this.around) return;
    for (const message of this.known.values()) if (!this.root.getObjectByName(message.component)) this.draw(message, this.around);
  }

  override switch(on: boolean, around: Surroundings | null): void {
    this.on = on;
    this.around = around;
    this.clear();
    if (around) this.build(around);
  }

  override build(around: Surroundings): void {
    for (const message of this.known.values()) this.draw(message, around);
  }

  override update({ world }: Surroundings): void {
    for (const child of this.root.children) {
      const node = world.find(child.name);
      if (!node) continue;
      child.matrix.copy(node.frame.matrixWorld);
      child.matrixWorldNeedsUpdate = true;
    }
  }
}
