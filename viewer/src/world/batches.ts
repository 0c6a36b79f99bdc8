import type { BufferGeometry, Material, Object3D, PerspectiveCamera } from "three";
import { DynamicDrawUsage, Frustum, InstancedMesh, Matrix4, Sphere } from "three";
import { coarse } from "./coarse";
import type { WorldNode } from "./node";

/** If the world has more triangles, small objects are drawn with fewer. */
const MANY = 100_000;
/** Cells along a mesh, and the radius in pixels below which it is used: a cell is at most two pixels. */
const LEVELS = [
  { cells: 24, below: 24 },
  { cells: 8, below: 8 },
  { cells: 4, below: 4 },
];
/** Radius in pixels: smaller objects are invisible. */
const SPECK = 0.6;
/** Metres by which the shadow of an object outside the image may reach into it. */
const SHADOW = 8;

interface Level {
  mesh: InstancedMesh;
  /** radius in pixels below which this level is used */
  below: number;
  /** the nodes of its instances, in order */
  nodes: WorldNode[];
}

/** The view: the camera's position in the world, its frustum, and pixels per metre at a distance of one metre. */
export interface Look {
  frustum: Frustum;
  camera: PerspectiveCamera;
  pixels: number;
}

export function lookOf(camera: PerspectiveCamera, height: number): Look {
  const seen = new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse);
  return { frustum: new Frustum().setFromProjectionMatrix(seen), camera, pixels: height / 2 / Math.tan((camera.fov * Math.PI) / 360) };
}

/** Many nodes with the same mesh and materials, drawn in one call; small ones with fewer triangles. */
export class Batch {
  readonly levels: Level[];
  private readonly place = new Matrix4();
  private readonly sphere = new Sphere();
  private readonly left = new Set<WorldNode>();

  constructor(
    private readonly geometry: BufferGeometry,
    materials: Material[],
    private readonly nodes: WorldNode[],
  ) {
    const triangles = ((geometry.getIndex()?.count ?? 0) / 3) * nodes.length;
    const levels = triangles < MANY ? [] : LEVELS.map(({ cells, below }) => ({ geometry: coarse(geometry, cells), below }));
    this.levels = [{ geometry, below: Infinity }, ...levels].map((level) => this.makeLevel(level.geometry, materials, level.below));
  }

  private makeLevel(geometry: BufferGeometry, materials: Material[], below: number): Level {
    const mesh = new InstancedMesh(geometry, materials.length === 1 ? (materials[0] as Material) : materials, this.nodes.length);
    mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    // nodes outside the frustum are culled one by one
    mesh.frustumCulled = false;
    mesh.castShadow = mesh.receiveShadow = true;
    const level = { mesh, below, nodes: [] };
    mesh.userData["level"] = level;
    return level;
  }

  /** Choose the level of each node, if it is visible, and update its frame. */
  sort({ frustum, camera, pixels }: Look): void {
    for (const level of this.levels) level.nodes.length = 0;
    const { boundingSphere } = this.geometry;
    for (const node of this.nodes) {
      if (!node.visible || this.left.has(node)) continue;
      this.place.multiplyMatrices(node.frame.matrixWorld, node.stretch);
      if (boundingSphere) {
        this.sphere.copy(boundingSphere).applyMatrix4(this.place);
        const size = (this.sphere.radius * pixels) / Math.max(this.sphere.center.distanceTo(camera.position), 1e-3);
        this.sphere.radius += SHADOW;
        if (size < SPECK || !frustum.intersectsSphere(this.sphere)) continue;
        this.add(node, size);
      } else this.add(node, Infinity);
    }
    for (const { mesh, nodes } of this.levels) {
      mesh.count = nodes.length;
      mesh.visible = nodes.length > 0;
      mesh.instanceMatrix.needsUpdate = true;
    }
  }

  private add(node: WorldNode, size: number): void {
    let level = this.levels[0] as Level;
    for (const one of this.levels) if (size < one.below) level = one;
    level.mesh.setMatrixAt(level.nodes.length, this.place);
    level.nodes.push(node);
  }

  /** The node is no longer drawn by this batch. */
  leave(node: WorldNode): void {
    this.left.add(node);
  }
}

/** The node of a drawn object. */
export function nodeOf(object: Object3D, instance: number | undefined): WorldNode | null {
  const level = object.userData["level"] as Level | undefined;
  if (level !== undefined && instance !== undefined) return level.nodes[instance] ?? null;
  return (object.userData["node"] as WorldNode | undefined) ?? null;
}
