import type { BufferGeometry, Material, Object3D } from "three";
import { DynamicDrawUsage, InstancedMesh, Matrix4 } from "three";
import type { WorldNode } from "./node";

const hidden = new Matrix4().makeScale(0, 0, 0);

/** Many nodes with the same mesh and materials, drawn in one go. */
export class Batch {
  readonly mesh: InstancedMesh;
  private readonly place = new Matrix4();
  private readonly left = new Set<WorldNode>();

  constructor(
    geometry: BufferGeometry,
    materials: Material[],
    readonly nodes: WorldNode[],
  ) {
    this.mesh = new InstancedMesh(geometry, materials.length === 1 ? (materials[0] as Material) : materials, nodes.length);
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    // they move: a sphere around all of them would be out of date
    this.mesh.frustumCulled = false;
    this.mesh.castShadow = this.mesh.receiveShadow = true;
    this.mesh.userData["batch"] = this;
  }

  /** Take over the frames of the nodes, of all or only of those that move. */
  update(all: boolean): void {
    let changed = false;
    for (let i = 0; i < this.nodes.length; i++) {
      const node = this.nodes[i] as WorldNode;
      if (!all && !node.moves) continue;
      changed = true;
      const seen = node.visible && !this.left.has(node);
      this.mesh.setMatrixAt(i, seen ? this.place.multiplyMatrices(node.frame.matrixWorld, node.stretch) : hidden);
    }
    if (changed) this.mesh.instanceMatrix.needsUpdate = true;
  }

  /** The node is drawn otherwise from now on. */
  leave(node: WorldNode): void {
    this.left.add(node);
    this.update(true);
  }
}

/** The node that a drawn object shows. */
export function nodeOf(object: Object3D, instance: number | undefined): WorldNode | null {
  const batch = object.userData["batch"] as Batch | undefined;
  if (batch !== undefined && instance !== undefined) return batch.nodes[instance] ?? null;
  return (object.userData["node"] as WorldNode | undefined) ?? null;
}
