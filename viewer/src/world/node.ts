import type { Object3D } from "three";
import { Group, Matrix4 } from "three";
import type { NodeDescription } from "../generated/protocol";

/** A node of the world: its rigid frame, and its drawn objects. */
export class WorldNode {
  /** the rigid frame of the node */
  readonly frame = new Group();
  /** scale and shear of its mesh */
  readonly stretch = new Matrix4();
  readonly children: WorldNode[] = [];
  /** moves by itself, or with a parent */
  moves = false;
  visible: boolean;
  color: [number, number, number, number] | null;
  /** the mesh, if it is not drawn by a batch */
  drawn: Object3D | null = null;

  constructor(
    readonly index: number,
    readonly description: NodeDescription,
    readonly parent: WorldNode | null,
  ) {
    const { position, quaternion, stretch } = description;
    const [w, x, y, z] = quaternion;
    this.frame.position.set(...position);
    this.frame.quaternion.set(x, y, z, w);
    this.frame.name = description.name;
    this.visible = description.visible;
    this.color = description.color;
    if (stretch) {
      const [a, b, c, d, e, f, g, i, j] = stretch as [number, number, number, number, number, number, number, number, number];
      this.stretch.set(a, b, c, 0, d, e, f, 0, g, i, j, 0, 0, 0, 0, 1);
    }
    parent?.children.push(this);
  }

  get name(): string {
    return this.description.name;
  }

  /** The node and its descendants. */
  *walk(): Generator<WorldNode> {
    yield this;
    for (const child of this.children) yield* child.walk();
  }

  /** The nearest node, from here upward, that fulfils a condition. */
  find(test: (node: WorldNode) => boolean): WorldNode | null {
    if (test(this)) return this;
    return this.parent?.find(test) ?? null;
  }
}
