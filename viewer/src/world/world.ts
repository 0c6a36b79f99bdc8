import type { BufferGeometry, Material, Raycaster } from "three";
import { Box3, Group, Matrix3, Mesh, Sphere, Vector3 } from "three";
import type { PoseFrame } from "../connection/frames";
import { fetchFile } from "../connection/tape";
import type { Appearance, SceneDescription } from "../generated/protocol";
import type { Look } from "./batches";
import { Batch } from "./batches";
import { GeometryStore } from "./geometry";
import { MaterialStore } from "./materials";
import { WorldNode } from "./node";

/** How the surfaces of a world are drawn. */
export interface Surfaces {
  anisotropy: number;
  /** without gloss */
  matt: boolean;
}

/** Minimum number of nodes with the same appearance that are drawn as a batch. */
const BATCH_FROM = 4;

/** Walls have normals whose vertical part is smaller. */
const STEEP = 0.5;

const geometries = new GeometryStore(fetchFile);

/** A deformable body: each vertex of its geometry follows a node. */
class Flex {
  readonly geometry: BufferGeometry;
  private readonly offsets: number[] = [];

  constructor(
    private readonly node: WorldNode,
    geometry: BufferGeometry,
    private readonly followed: WorldNode[],
  ) {
    this.geometry = geometry.clone();
    const places = this.geometry.getAttribute("position");
    followed.forEach(({ description }, k) => {
      const [x, y, z] = description.position;
      this.offsets.push(places.getX(k) - x, places.getY(k) - y, places.getZ(k) - z);
    });
  }

  /** Take over the present positions of the nodes. */
  bend(): void {
    const places = this.geometry.getAttribute("position");
    const origin = this.node.frame.position;
    this.followed.forEach(({ frame: { position } }, k) => {
      const [x, y, z] = this.offsets.slice(3 * k, 3 * k + 3) as [number, number, number];
      places.setXYZ(k, position.x - origin.x + x, position.y - origin.y + y, position.z - origin.z + z);
    });
    places.needsUpdate = true;
    this.geometry.computeVertexNormals();
    this.geometry.computeBoundingSphere();
    this.geometry.computeBoundingBox();
  }
}

/** A world as described, at the latest poses. */
export class World {
  readonly root = new Group();
  readonly nodes: WorldNode[] = [];
  private readonly names = new Map<string, WorldNode>();
  private readonly moving: WorldNode[];
  private readonly batches: Batch[] = [];
  private readonly batchOf = new Map<WorldNode, Batch>();
  private readonly flexes = new Map<WorldNode, Flex>();

  /** @param from gives the files of the world; by default, those of the simulator or of the run in this page */
  static async load(description: SceneDescription, { anisotropy, matt }: Surfaces, onChange: () => void, from?: (url: string) => Promise<Response>): Promise<World> {
    const meshes = await (from ? new GeometryStore(from) : geometries).load(description.meshes);
    const materials = new MaterialStore(description.materials, description.view.wireframe, anisotropy, matt, onChange);
    return new World(description, meshes, materials);
  }

  private constructor(
    readonly description: SceneDescription,
    private readonly meshes: BufferGeometry[],
    private readonly materials: MaterialStore,
  ) {
    description.nodes.forEach((described, index) => {
      const parent = described.parent < 0 ? null : (this.nodes[described.parent] ?? null);
      const node = new WorldNode(index, described, parent);
      node.moves = described.frame !== "" || (parent?.moves ?? false);
      this.nodes.push(node);
      this.names.set(described.name, node);
      // poses in the world frame, independent of the parent
      (parent && described.frame !== "world" ? parent.frame : this.root).add(node.frame);
    });
    this.moving = description.moving.map((index) => this.nodes[index] as WorldNode);
    this.placeMovers();
    this.draw();
  }

  find(name: string): WorldNode | null {
    return this.names.get(name) ?? null;
  }

  /** Take over the poses that nodes have in an earlier description of this world, until the first snapshot of this one. */
  continue(earlier: World): void {
    for (const { name, parent, description, frame } of this.moving) {
      const before = earlier.find(name);
      if (!before || before.description.frame !== description.frame || before.parent?.name !== parent?.name) continue;
      frame.position.copy(before.frame.position);
      frame.quaternion.copy(before.frame.quaternion);
    }
    this.root.updateMatrixWorld();
    for (const flex of this.flexes.values()) flex.bend();
  }

  /** Apply poses; false if they belong to another world. */
  apply({ revision, poses }: PoseFrame): boolean {
    if (revision !== this.description.revision) return false;
    this.moving.forEach(({ frame }, i) => {
      const at = i * 7;
      frame.position.fromArray(poses, at);
      frame.quaternion.set(poses[at + 4] as number, poses[at + 5] as number, poses[at + 6] as number, poses[at + 3] as number);
    });
    this.root.updateMatrixWorld();
    for (const flex of this.flexes.values()) flex.bend();
    return true;
  }

  /** Called before each frame: select the levels of nodes. */
  sort(look: Look): void {
    for (const batch of this.batches) batch.sort(look);
  }

  /** A node was hidden, shown or recoloured. */
  change({ node: name, visible, color, light }: Appearance): void {
    const node = this.find(name);
    if (!node) return;
    if (light) node.description.light = light;
    node.visible = visible;
    if (node.color?.join() !== color?.join()) {
      node.color = color;
      this.batchOf.get(node)?.leave(node);
      this.batchOf.delete(node);
      node.drawn?.removeFromParent();
      this.drawAlone(node);
    }
    if (node.drawn) node.drawn.visible = visible;
    // lamps in a hidden frame give no light
    if (node.description.light) node.frame.visible = visible;
  }

  /** A sphere around all drawn objects. */
  bounds(): Sphere {
    const box = this.boxOf(this.nodes);
    return box.isEmpty() ? new Sphere(new Vector3(), 5) : box.getBoundingSphere(new Sphere());
  }

  /** A box around a node and its descendants, along the axes of the world; empty if nothing is drawn. */
  boxOf(nodes: Iterable<WorldNode>): Box3 {
    const box = new Box3();
    const part = new Box3();
    for (const node of nodes) {
      const mesh = this.flexes.get(node)?.geometry ?? this.meshes[node.description.mesh];
      if (!mesh?.boundingBox || !node.visible) continue;
      box.union(part.copy(mesh.boundingBox).applyMatrix4(node.stretch).applyMatrix4(node.frame.matrixWorld));
    }
    return box;
  }

  /** A sphere around a node and its descendants. */
  boundsOf(node: WorldNode): Sphere {
    const box = this.boxOf(node.walk());
    if (box.isEmpty()) return new Sphere(node.frame.getWorldPosition(new Vector3()), 0.5);
    return box.getBoundingSphere(new Sphere());
  }

  /** Whether something steep that does not move is hit by a ray: a wall, a fence, a hedge. */
  isWalled(ray: Raycaster): boolean {
    const span = new Box3().setFromPoints([ray.ray.origin, ray.ray.at(ray.far, new Vector3())]);
    return this.nodes.some((node) => {
      const geometry = this.meshes[node.description.mesh];
      if (!geometry || node.moves || node.description.shapes.length === 0 || !this.boxOf([node]).intersectsBox(span)) return false;
      const mesh = new Mesh(geometry);
      mesh.matrixWorld.multiplyMatrices(node.frame.matrixWorld, node.stretch);
      const turn = new Matrix3().getNormalMatrix(mesh.matrixWorld);
      return ray.intersectObject(mesh).some(({ face }) => face && Math.abs(face.normal.clone().applyNormalMatrix(turn).z) < STEEP);
    });
  }

  dispose(): void {
    this.root.removeFromParent();
    for (const { mesh } of this.batches.flatMap(({ levels }) => levels)) mesh.dispose();
    for (const { geometry } of this.flexes.values()) geometry.dispose();
    this.materials.dispose();
  }

  /** Poses in the world frame before the first snapshot: computed from the poses in the parent's frame. */
  private placeMovers(): void {
    for (const node of this.nodes) {
      if (node.description.frame !== "world" || !node.parent) continue;
      node.parent.frame.updateWorldMatrix(true, false);
      node.frame.applyMatrix4(node.parent.frame.matrixWorld);
    }
    this.root.updateMatrixWorld(true);
    // matrices of fixed nodes need not be updated
    for (const node of this.nodes) node.frame.matrixAutoUpdate = node.description.frame !== "";
  }

  private draw(): void {
    const alike = new Map<string, WorldNode[]>();
    for (const node of this.nodes) {
      const { mesh, materials, color } = node.description;
      if (mesh < 0) continue;
      // a mirrored mesh has the opposite winding: a batch cannot contain both
      const key = node.stretch.determinant() < 0 || node.description.follows ? `${node.index}` : `${mesh}/${materials.join()}/${color?.join() ?? ""}`;
      const group = alike.get(key);
      if (group) group.push(node);
      else alike.set(key, [node]);
    }
    for (const group of alike.values()) {
      if (group.length < BATCH_FROM) group.forEach((node) => this.drawAlone(node));
      else this.drawBatch(group);
    }
    this.root.updateMatrixWorld();
  }

  private look(node: WorldNode): { geometry: BufferGeometry; materials: Material[] } | null {
    const geometry = this.meshes[node.description.mesh];
    if (!geometry) return null;
    return { geometry, materials: node.description.materials.map((index) => this.materials.get(index, node.color)) };
  }

  private drawAlone(node: WorldNode): void {
    const look = this.look(node);
    if (!look) return;
    const { follows } = node.description;
    if (follows && !this.flexes.has(node)) this.flexes.set(node, new Flex(node, look.geometry, follows.map((index) => this.nodes[index] as WorldNode)));
    const mesh = new Mesh(this.flexes.get(node)?.geometry ?? look.geometry, look.materials.length === 1 ? (look.materials[0] as Material) : look.materials);
    mesh.matrixAutoUpdate = false;
    mesh.matrix.copy(node.stretch);
    mesh.castShadow = mesh.receiveShadow = true;
    mesh.visible = node.visible;
    mesh.userData["node"] = node;
    node.drawn = mesh;
    node.frame.add(mesh);
    mesh.updateMatrixWorld(true);
  }

  private drawBatch(group: WorldNode[]): void {
    const look = this.look(group[0] as WorldNode);
    if (!look) return;
    const batch = new Batch(look.geometry, look.materials, group);
    for (const node of group) this.batchOf.set(node, batch);
    this.batches.push(batch);
    this.root.add(...batch.levels.map(({ mesh }) => mesh));
  }
}
