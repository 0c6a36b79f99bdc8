import { BufferAttribute, BufferGeometry, Color, DoubleSide, Group, LineBasicMaterial, LineSegments, Mesh, MeshBasicMaterial } from "three";
import type { Connection } from "../connection/connection";
import type { Frustum } from "../generated/protocol";
import type { Surroundings } from "./layer";
import { discard } from "./layer";
import { SensorLayer } from "./sensorlayer";

/** Distance at which longer fields of view fade out, m: they would hide the world. */
const LONGEST = 3;
const LINES = new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false, toneMapped: false });
const FACES = new MeshBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false, side: DoubleSide, toneMapped: false });
/** Opacity of faces and lines at the camera; both fade with the distance if the field of view is longer. */
const [FACE, LINE] = [0.2, 1];
const FADED = 0.12;

type Point = readonly [number, number, number];

/** The fields of view of cameras, each in its own colour. */
export class Frustums extends SensorLayer<Frustum> {
  constructor(connection: Connection, changed: () => void) {
    super("frustums", "fields of view of cameras", changed);
    connection.on("frustum", (frustum) => this.take(frustum));
  }

  override draw(frustum: Frustum, { world, components }: Surroundings): void {
    const { component } = frustum;
    for (const child of [...this.root.children]) if (child.name === component) discard(child);
    if (!world.find(component) || !this.shows(component)) return;
    const color = new Color(components.colorOf(component));
    const parts = new Group();
    parts.name = component;
    parts.matrixAutoUpdate = false;
    parts.add(new LineSegments(outline(frustum, color), LINES), new Mesh(sides(frustum, color), FACES));
    parts.traverse((object) => {
      object.raycast = () => {};
      object.frustumCulled = false;
    });
    this.root.add(parts);
  }
}

/** The border of the image at a distance along the axis; on a sphere for wide-angle lenses. */
function border({ rim }: Frustum, distance: number): Point[] {
  const flat = rim.every(([, , z]) => z > 0.2);
  return rim.map(([x, y, z]) => {
    const scale = flat ? distance / z : distance;
    return [x * scale, y * scale, z * scale];
  });
}

function ends({ far }: Frustum): boolean {
  return far <= LONGEST;
}

function outline(frustum: Frustum, color: Color): BufferGeometry {
  const [near, far] = [border(frustum, frustum.near), border(frustum, Math.min(frustum.far, LONGEST))];
  const last = ends(frustum) ? LINE : FADED;
  const side = near.length / 4;
  const points: Point[] = [];
  const alphas: number[] = [];
  const line = (from: Point, to: Point, first: number, second: number): void => {
    points.push(from, to);
    alphas.push(first, second);
  };
  near.forEach((point, i) => {
    const next = (i + 1) % near.length;
    line(point, near[next] as Point, LINE, LINE);
    line(far[i] as Point, far[next] as Point, last, last);
    if (i % side === 0) line([0, 0, 0], far[i] as Point, LINE, last);
  });
  return colored(points, alphas, color);
}

/** The four sides, as triangles from the camera to the border. */
function sides(frustum: Frustum, color: Color): BufferGeometry {
  const far = border(frustum, Math.min(frustum.far, LONGEST));
  const last = ends(frustum) ? FACE : 0.02;
  const points = far.flatMap((point, i): Point[] => [[0, 0, 0], point, far[(i + 1) % far.length] as Point]);
  return colored(points, far.flatMap(() => [FACE, last, last]), color);
}

function colored(points: Point[], alphas: number[], { r, g, b }: Color): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(points.flat()), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(alphas.flatMap((alpha) => [r, g, b, alpha])), 4));
  return geometry;
}
