import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Line, LineBasicMaterial, Points, PointsMaterial, Vector3 } from "three";
import type { WorldNode } from "../world/node";
import type { Surroundings } from "./layer";
import { Layer } from "./layer";

const LENGTH = 3000;
const STEP = 0.03; // metres
const LEAP = 2; // metres between two frames: the robot was moved, not driven
const MOST = 200;
const COLORS = [0xd9660c, 0x2f7fc2, 0x3a9a4a, 0xb14cc0, 0xc23b4a, 0x0f9a9a];

interface Trail {
  node: WorldNode;
  line: Line;
  count: number;
  last: Vector3;
}

/** The past paths of robots. */
export class Trails extends Layer {
  private trails: Trail[] = [];
  /** paths of a description of the world that another one has replaced, e.g. because a robot has grasped something */
  private before = new Map<string, Trail>();
  private key = "";
  private readonly place = new Vector3();
  private readonly dot = new Vector3();

  constructor() {
    super("trails", "trails of robots");
  }

  override build({ world }: Surroundings): void {
    if (world.description.key !== this.key) this.before.clear();
    this.key = world.description.key;
    const robots = world.nodes.filter((node) => node.description.kind.includes("robot")).slice(0, MOST);
    this.trails = robots.map((node, i) => {
      const geometry = new BufferGeometry();
      const earlier = this.before.get(node.name);
      const points = (earlier?.line.geometry.getAttribute("position").array as Float32Array | undefined) ?? new Float32Array(LENGTH * 3);
      geometry.setAttribute("position", new BufferAttribute(points, 3).setUsage(DynamicDrawUsage));
      geometry.setDrawRange(0, earlier?.count ?? 0);
      const line = new Line(geometry, new LineBasicMaterial({ color: COLORS[i % COLORS.length] as number, toneMapped: false }));
      line.frustumCulled = false;
      line.raycast = () => {};
      // lines are always one pixel wide: dots make them visible
      const dots = new Points(geometry, new PointsMaterial({ color: line.material.color, size: 3.5, sizeAttenuation: false, toneMapped: false }));
      dots.frustumCulled = false;
      dots.raycast = () => {};
      this.root.add(line, dots);
      return { node, line, count: earlier?.count ?? 0, last: earlier?.last ?? new Vector3(Infinity, 0, 0) };
    });
  }

  override clear(): void {
    for (const trail of this.trails) this.before.set(trail.node.name, trail);
    super.clear();
    this.trails = [];
  }

  override update(): void {
    for (const trail of this.trails) {
      trail.node.frame.getWorldPosition(this.place);
      const way = this.place.distanceTo(trail.last);
      if (way < STEP) continue;
      if (way > LEAP) trail.count = 0;
      this.extend(trail, trail.count > 0 ? Math.floor(way / STEP) : 1);
    }
  }

  /** The number of dots depends on the length of the path, not on the frame rate. */
  private extend(trail: Trail, dots: number): void {
    const { geometry } = trail.line;
    const points = geometry.getAttribute("position") as BufferAttribute;
    const surplus = Math.max(0, trail.count + dots - LENGTH);
    if (surplus > 0) points.array.copyWithin(0, 3 * surplus); // delete the oldest
    trail.count -= surplus;
    for (let i = 1; i <= dots; i++) {
      this.dot.copy(this.place);
      if (i < dots) this.dot.lerpVectors(trail.last, this.place, i / dots);
      points.setXYZ(trail.count, this.dot.x, this.dot.y, this.dot.z + 0.02);
      trail.count += 1;
    }
    points.needsUpdate = true;
    trail.last.copy(this.place);
    geometry.setDrawRange(0, trail.count);
  }
}
