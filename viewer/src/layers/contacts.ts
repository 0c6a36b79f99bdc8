import { BufferAttribute, BufferGeometry, LineBasicMaterial, LineSegments, Points, PointsMaterial } from "three";
import type { Connection } from "../connection/connection";
import { Layer } from "./layer";

const DOT = new PointsMaterial({ color: 0xd12fae, size: 7, sizeAttenuation: false, depthTest: false, toneMapped: false });
const FORCE = new LineBasicMaterial({ color: 0xd12fae, depthTest: false, toneMapped: false });
/** Drawn length per newton, and maximum length, m. */
const METRES = 0.004;
const LONGEST = 1.5;

/** Contact points and contact forces. */
export class Contacts extends Layer {
  private readonly dots = new Points(new BufferGeometry(), DOT);
  private readonly forces = new LineSegments(new BufferGeometry(), FORCE);

  constructor(connection: Connection, changed: () => void) {
    super("contacts", "contact points and forces");
    this.dots.frustumCulled = this.forces.frustumCulled = false;
    this.dots.renderOrder = this.forces.renderOrder = 3;
    this.root.add(this.dots, this.forces);
    connection.on("contacts", ({ payload }) => {
      if (!this.on) return;
      this.show(new Float32Array(payload));
      changed();
    });
  }

  override clear(): void {
    this.show(new Float32Array(0));
  }

  private show(numbers: Float32Array): void {
    const count = Math.floor(numbers.length / 6);
    const points = new Float32Array(count * 3);
    const lines = new Float32Array(count * 6);
    for (let i = 0; i < count; i++) {
      const [x, y, z, fx, fy, fz] = numbers.subarray(i * 6, i * 6 + 6) as unknown as [number, number, number, number, number, number];
      const force = Math.hypot(fx, fy, fz);
      const scale = force > 0 ? Math.min(force * METRES, LONGEST) / force : 0;
      points.set([x, y, z], i * 3);
      lines.set([x, y, z, x + fx * scale, y + fy * scale, z + fz * scale], i * 6);
    }
    this.dots.geometry.setAttribute("position", new BufferAttribute(points, 3));
    this.forces.geometry.setAttribute("position", new BufferAttribute(lines, 3));
  }
}
