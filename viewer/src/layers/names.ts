import { Vector3 } from "three";
import { h } from "../ui/dom";
import type { Stage } from "../view/stage";
import type { Surroundings } from "./layer";
import { Layer } from "./layer";

const MOST = 100;
const FARTHEST = 80; // metres

/** The names of robots, written over them. */
export class Names extends Layer {
  readonly element = h("div", { class: "names", "aria-hidden": "true" });
  private readonly labels = new Map<string, HTMLElement>();
  private readonly place = new Vector3();

  constructor(private readonly stage: Stage) {
    super("names", "names of robots");
  }

  override build({ world }: Surroundings): void {
    for (const node of world.nodes.filter(({ description }) => description.kind.includes("robot")).slice(0, MOST)) {
      const label = h("span", {}, node.name);
      this.labels.set(node.name, label);
      this.element.append(label);
    }
  }

  override clear(): void {
    this.labels.clear();
    this.element.replaceChildren();
  }

  override update({ world }: Surroundings): void {
    const { clientWidth: width, clientHeight: height } = this.stage.element;
    const { camera, position } = this.stage.view;
    for (const [name, label] of this.labels) {
      const node = world.find(name);
      if (!node) continue;
      const bounds = world.boundsOf(node);
      const far = bounds.center.distanceTo(position);
      this.place.copy(bounds.center).setZ(bounds.center.z + bounds.radius).project(camera);
      const seen = this.place.z < 1 && Math.abs(this.place.x) < 1.1 && Math.abs(this.place.y) < 1.1 && far < FARTHEST;
      label.hidden = !seen;
      if (seen) label.style.transform = `translate(-50%, -100%) translate(${((this.place.x + 1) / 2) * width}px, ${((1 - this.place.y) / 2) * height}px)`;
    }
  }
}
