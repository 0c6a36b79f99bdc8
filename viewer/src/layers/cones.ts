import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial, SphereGeometry, DoubleSide } from "three";
import type { Connection } from "../connection/connection";
import type { Cone } from "../generated/protocol";
import type { Surroundings } from "./layer";
import { discard } from "./layer";
import { SensorLayer } from "./sensorlayer";

const LINES = new LineBasicMaterial({ color: 0x2f7fc2, transparent: true, opacity: 0.9, toneMapped: false });
const SEEING = new LineBasicMaterial({ color: 0xd9660c, transparent: true, opacity: 0.9, toneMapped: false });
const BODY = new MeshBasicMaterial({ color: 0x4f9fe2, transparent: true, opacity: 0.09, depthWrite: false, side: DoubleSide, toneMapped: false });

/** The fields of view of proximity sensors. */
export class Cones extends SensorLayer<Cone> {
  constructor(connection: Connection, changed: () => void) {
    super("cones", "cones of proximity sensors", changed);
    connection.on("cone", (cone) => this.take(cone));
  }

  override draw(cone: Cone, { world }: Surroundings): void {
    for (const child of [...this.root.children]) if (child.name === cone.component) discard(child);
    if (!world.find(cone.component) || !this.shows(cone.component)) return;
    const material = cone.seen.length > 0 ? SEEING : LINES;
    const half = Math.min(cone.angle / 2, Math.PI);
    const lines = new LineSegments(outline(cone.reach, half), material);
    lines.name = cone.component;
    lines.matrixAutoUpdate = false;
    // a spherical cap around Y, rotated to point along X
    const body = new Mesh(new SphereGeometry(cone.reach, 32, 12, 0, Math.PI * 2, 0, half).rotateZ(-Math.PI / 2), BODY);
    lines.add(body);
    lines.traverse((object) => (object.raycast = () => {}));
    this.root.add(lines);
  }
}

type Point = [number, number, number];

const STEPS = 48;

/** The rim of a cone around X, and lines from its tip to the rim; three circles for a whole sphere. */
function outline(reach: number, half: number): BufferGeometry {
  const points: number[] = [];
  const circle = (at: (cos: number, sin: number) => Point): void => {
    for (let i = 0; i < STEPS; i++) {
      for (const angle of [(i * 2 * Math.PI) / STEPS, ((i + 1) * 2 * Math.PI) / STEPS]) {
        points.push(...at(Math.cos(angle), Math.sin(angle)));
      }
    }
  };
  if (half > 0.95 * Math.PI) {
    circle((c, s) => [reach * c, reach * s, 0]);
    circle((c, s) => [reach * c, 0, reach * s]);
    circle((c, s) => [0, reach * c, reach * s]);
  } else {
    const [along, rim] = [reach * Math.cos(half), reach * Math.sin(half)];
    circle((c, s) => [along, rim * c, rim * s]);
    for (const [c, s] of [[1, 0], [0, 1], [-1, 0], [0, -1]] as const) points.push(0, 0, 0, along, rim * c, rim * s);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  return geometry;
}
