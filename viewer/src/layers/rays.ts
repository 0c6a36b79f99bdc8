import { BufferAttribute, BufferGeometry, Color, LineBasicMaterial, LineSegments, Points, PointsMaterial } from "three";
import type { Connection } from "../connection/connection";
import { Layer, discard } from "./layer";

const GREEN = new Color(0x16a863);
const BEAM = new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false, toneMapped: false });
const HIT = new PointsMaterial({ color: 0xff5a2a, size: 4, sizeAttenuation: false, toneMapped: false });
/** The points of a cloud are many and dense. */
const POINT = new PointsMaterial({ color: 0xff5a2a, size: 2, sizeAttenuation: false, toneMapped: false });

/** Opacity of rays: few are seen on every ground, many do not hide the world. */
const opacity = (count: number): number => Math.min(0.85, Math.max(0.3, 6 / Math.sqrt(count)));
/** Length on which a ray without a hit fades out, m: its full length would hide the world behind it. */
const MISS = 5;

interface Drawn {
  beams: LineSegments;
  hits: Points;
}

/** Rays of laser scanners and similar sensors: a line for each ray, a dot at each hit; and the points of depth cameras. */
export class Rays extends Layer {
  private readonly drawn = new Map<string, Drawn>();
  private shown = new Set<string>();

  constructor(connection: Connection, changed: () => void) {
    super("rays", "rays and points");
    connection.on("rays", ({ component, payload }) => {
      if (!this.shown.has(component)) return;
      this.show(component, new Float32Array(payload));
      changed();
    });
    connection.on("cloud", ({ component, payload }) => {
      if (!this.shown.has(component)) return;
      this.showPoints(component, new Float32Array(payload));
      changed();
    });
  }

  /** The sensors whose rays and points are shown, also if the overlay of all sensors is off. */
  keep(components: string[]): void {
    this.shown = new Set(components);
    for (const [name, { beams, hits }] of this.drawn) {
      if (this.shown.has(name)) continue;
      discard(beams);
      discard(hits);
      this.drawn.delete(name);
    }
  }

  private showPoints(component: string, points: Float32Array): void {
    const { hits } = this.drawn.get(component) ?? this.make(component);
    hits.material = POINT;
    hits.geometry.setAttribute("position", new BufferAttribute(points, 3));
  }

  override switch(on: boolean): void {
    this.on = on;
  }

  private show(component: string, numbers: Float32Array): void {
    const count = Math.floor(numbers.length / 7);
    const ends = new Float32Array(count * 6);
    const colors = new Float32Array(count * 8);
    const hits: number[] = [];
    const opaque = opacity(count);
    for (let i = 0; i < count; i++) {
      const [x, y, z, toX, toY, toZ, hit] = numbers.subarray(i * 7, i * 7 + 7) as unknown as [number, number, number, number, number, number, number];
      const length = Math.hypot(toX - x, toY - y, toZ - z);
      const part = hit || length <= MISS ? 1 : MISS / length;
      ends.set([x, y, z, x + part * (toX - x), y + part * (toY - y), z + part * (toZ - z)], i * 6);
      colors.set([GREEN.r, GREEN.g, GREEN.b, opaque, GREEN.r, GREEN.g, GREEN.b, hit ? opaque : 0], i * 8);
      if (hit) hits.push(toX, toY, toZ);
    }
    const drawn = this.drawn.get(component) ?? this.make(component);
    drawn.beams.geometry.setAttribute("position", new BufferAttribute(ends, 3));
    drawn.beams.geometry.setAttribute("color", new BufferAttribute(colors, 4));
    drawn.hits.geometry.setAttribute("position", new BufferAttribute(new Float32Array(hits), 3));
  }

  private make(component: string): Drawn {
    const drawn = { beams: new LineSegments(new BufferGeometry(), BEAM), hits: new Points(new BufferGeometry(), HIT) };
    drawn.beams.frustumCulled = drawn.hits.frustumCulled = false;
    this.root.add(drawn.beams, drawn.hits);
    this.drawn.set(component, drawn);
    return drawn;
  }
}
