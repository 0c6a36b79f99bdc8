import type { Object3D, Scene } from "three";
import { Group } from "three";
import type { DisplayDescription } from "../generated/protocol";
import type { Components } from "../model/components";
import type { World } from "../world/world";

export interface Surroundings {
  world: World;
  components: Components;
}

/** An overlay of the world that can be switched on and off. */
export abstract class Layer {
  readonly root = new Group();
  on = false;

  constructor(
    readonly id: DisplayDescription["overlays"][number],
    readonly label: string,
  ) {
    this.root.name = id;
  }

  install(scene: Scene): void {
    scene.add(this.root);
  }

  switch(on: boolean, around: Surroundings | null): void {
    this.on = on;
    this.root.visible = on;
    this.clear();
    if (on && around) this.build(around);
  }

  /** Create the objects for the present world. */
  build(_around: Surroundings): void {}

  /** Called before each frame while the layer is on. */
  update(_around: Surroundings): void {}

  clear(): void {
    for (const child of [...this.root.children]) discard(child);
  }
}

export function discard(object: Object3D): void {
  object.removeFromParent();
  object.traverse((part) => {
    const { geometry } = part as unknown as { geometry?: { dispose(): void } };
    geometry?.dispose();
  });
}
