import { Vector3 } from "three";
import { h } from "../ui/dom";
import type { Stage } from "../view/stage";
import type { Surroundings } from "./layer";
import { Layer } from "./layer";

const MOST = 100;
const FARTHEST = 80; // metres

/** Pixels: of a line of text, of a letter, and beside the text; measuring elements would cause a new layout. */
const HEIGHT = 22;
const LETTER = 7.4;
const PADDING = 14;

interface Place {
  label: HTMLElement;
  x: number;
  y: number;
  /** metres from the camera */
  far: number;
}

/** Labels with the names of robots. */
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
      label.hidden = true; // until it has a position
      this.labels.set(node.name, label);
      this.element.append(label);
    }
  }

  override clear(): void {
    this.labels.clear();
    this.element.replaceChildren();
  }

  override update({ world, components }: Surroundings): void {
    const { clientWidth: width, clientHeight: height } = this.stage.element;
    const { camera, position } = this.stage.view;
    const chosen = components.robotOf(components.selected.value);
    const places: Place[] = [];
    for (const [name, label] of this.labels) {
      const node = world.find(name);
      if (!node) continue;
      const bounds = world.boundsOf(node);
      const far = bounds.center.distanceTo(position);
      this.place.copy(bounds.center).setZ(bounds.center.z + bounds.radius).project(camera);
      const seen = this.place.z < 1 && Math.abs(this.place.x) < 1.1 && Math.abs(this.place.y) < 1.1 && far < FARTHEST;
      if (seen) places.push({ label, x: ((this.place.x + 1) / 2) * width, y: ((1 - this.place.y) / 2) * height, far: name === chosen ? 0 : far });
      else label.hidden = true;
    }
    this.spread(places);
  }

  /** Show labels from near to far: a label that would cover another one moves up a little, or is left out. */
  private spread(places: Place[]): void {
    const taken: { left: number; right: number; top: number; bottom: number }[] = [];
    for (const { label, x, y } of places.sort((a, b) => a.far - b.far)) {
      const half = (label.textContent.length * LETTER + PADDING) / 2;
      const free = [0, 1, 2].map((line) => {
        const bottom = y - line * HEIGHT;
        return { left: x - half, right: x + half, top: bottom - HEIGHT, bottom };
      }).find((box) => taken.every((other) => box.right <= other.left || box.left >= other.right || box.bottom <= other.top || box.top >= other.bottom));
      label.hidden = !free;
      if (!free) continue;
      taken.push(free);
      label.style.transform = `translate(-50%, -100%) translate(${x}px, ${free.bottom}px)`;
    }
  }
}
