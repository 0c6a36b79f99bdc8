import { AxesHelper } from "three";
import type { Surroundings } from "./layer";
import { Layer } from "./layer";

const MOST = 500;
const SIZE: Record<string, number> = { robot: 0.8, external_robot: 0.8 };

/** Axes of robots, sensors and actuators: X red, Y green, Z blue. */
export class Frames extends Layer {
  constructor() {
    super("frames", "frames");
  }

  override build({ world }: Surroundings): void {
    for (const node of world.nodes.filter(({ description }) => description.kind !== "").slice(0, MOST)) {
      const axes = new AxesHelper(SIZE[node.description.kind] ?? 0.3);
      axes.name = node.name;
      axes.matrixAutoUpdate = false;
      axes.raycast = () => {};
      axes.renderOrder = 3;
      const { material } = axes;
      for (const one of Array.isArray(material) ? material : [material]) Object.assign(one, { depthTest: false, toneMapped: false });
      this.root.add(axes);
    }
  }

  override update({ world }: Surroundings): void {
    for (const axes of this.root.children) {
      const node = world.find(axes.name);
      if (node) axes.matrix.copy(node.frame.matrixWorld);
      axes.matrixWorldNeedsUpdate = true;
    }
  }
}
